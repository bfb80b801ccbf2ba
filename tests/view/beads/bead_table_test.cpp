#include "view/beads/bead_stream.h"

#include "base/error.h"
#include "base/input_file.h"
#include "corpus.h"
#include "gcode/reader.h"
#include "voxelize/beads/selection.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

namespace stratum::view {
namespace {

std::shared_ptr<const gcode::Toolpath> read(const char* name) {
    return std::make_shared<const gcode::Toolpath>(
        gcode::readToolpath(InputFile(test::sourceDir() / "data/gcode" / name).bytes(), name));
}

std::vector<std::uint32_t> allOf(const BeadTable& table, std::size_t count) {
    std::vector<std::uint32_t> words;
    for (std::size_t bead = 0; bead < table.beads();)
        for (const std::uint32_t word : table.part(bead, count)) words.push_back(word);
    return words;
}

TEST(BeadTable, IsOfLevelLayersAlone) {
    gcode::ReadOptions belt;
    belt.belt_angle = 45;
    EXPECT_THROW(BeadTable(std::make_shared<const gcode::Toolpath>(
                     gcode::readToolpath("M83\nG1 Z.3\nG1 X10 E1\n", "belt.gcode", belt))),
                 InputError);
}

// What the page reads of the table is the bead, to half a step.
TEST(BeadTable, HoldsTheBeads) {
    for (const char* name : {"tile.gcode", "tile_arcs.gcode", "vase.gcode"}) {
        SCOPED_TRACE(name);
        const auto print = read(name);
        const BeadTable table(print);
        const nlohmann::json head = table.head();
        const std::vector<std::uint32_t> words = allOf(table, 1000);
        ASSERT_EQ(words.size(), 4 * table.texels());
        ASSERT_EQ(head["beads"], print->beads.size());
        std::size_t texel = 0;
        const auto at = [&](std::uint32_t steps, int axis) {
            return head["low"][axis].get<double>() + steps * head["grain"][axis].get<double>();
        };
        for (const gcode::Bead& bead : print->beads) {
            const std::uint32_t* w = &words[4 * texel];
            const double step = 0.51 * head["grain"][0].get<double>() + 1e-9;
            ASSERT_LT(step, 0.001);
            EXPECT_NEAR(at(w[0] & 65535, 0), bead.x0, step);
            EXPECT_NEAR(at(w[1] >> 16, 1), bead.y1, 0.51 * head["grain"][1].get<double>() + 1e-9);
            EXPECT_NEAR(at(w[2] >> 16, 2), bead.z1, 0.51 * head["grain"][2].get<double>() + 1e-9);
            EXPECT_NEAR((w[3] & 4095) * 0.004, bead.width, 0.0021);
            ASSERT_EQ(w[3] >> 13, bead.run);
            EXPECT_EQ(table.runs()[4 * bead.run + 2], print->runOf(bead).layer);
            const bool extra = (w[3] >> 12 & 1) != 0;
            ASSERT_EQ(extra, bead.arc >= 0);
            ++texel;
            if (!extra) continue;
            const gcode::Arc& arc = print->arcs[static_cast<std::size_t>(bead.arc)];
            EXPECT_NEAR(std::bit_cast<float>(w[4]) + head["low"][0].get<double>(), arc.center_x, 1e-4);
            EXPECT_NEAR(std::bit_cast<float>(w[6]), arc.sweep, 1e-6);
            ++texel;
        }
        EXPECT_EQ(head["kinds"]["arcs"], std::string(name) == "tile_arcs.gcode");
        EXPECT_EQ(head["kinds"]["slopes"], std::string(name) == "vase.gcode");
        EXPECT_EQ(head["kinds"]["corners"], false);
        // Parts of any size are the same table.
        EXPECT_EQ(words, allOf(table, 7));
    }
}

// The page draws within that box alone: an arc reaches beyond its ends.
TEST(BeadTable, ItsBoxHasAllOfAnArc) {
    const nlohmann::json head =
        BeadTable(std::make_shared<const gcode::Toolpath>(gcode::readToolpath(
                      "M83\nG0 X160 Y100 Z.2\nG3 X40 I-60 J0 E1\nG3 X160 I60 J0 E1\n", "ring.gcode")))
            .head();
    const auto high = [&](int axis) {
        return head["low"][axis].get<double>() + 65535 * head["grain"][axis].get<double>();
    };
    EXPECT_NEAR(head["low"][1].get<double>(), 40, 1e-9);
    EXPECT_NEAR(high(1), 160, 1e-9);
    EXPECT_NEAR(head["low"][0].get<double>(), 40, 1e-9);
    EXPECT_NEAR(high(0), 160, 1e-9);
}

TEST(BeadTable, SaysWhatIsPrintedByVolume) {
    const auto print = read("tile.gcode");
    const nlohmann::json printed = BeadTable(print).head()["printed"]["volume"];
    ASSERT_EQ(printed.size(), 200U);
    EXPECT_EQ(printed.back(), print->beads.size());
    const auto volumeOf = [&](std::uint32_t beads) {
        double volume = 0;
        for (std::uint32_t bead = 0; bead < beads; ++bead)
            if (print->runOf(print->beads[bead]).layer > 0) volume += gcode::laidVolume(*print, bead);
        return volume;
    };
    EXPECT_NEAR(volumeOf(printed[99].get<std::uint32_t>()) / volumeOf(printed[199].get<std::uint32_t>()), 0.5, 0.01);
}

// --printed 50% means half of the part, whatever was primed before.
TEST(BeadTable, SharesOfTheVolumeLeavePrimeLinesOut) {
    const auto print = std::make_shared<const gcode::Toolpath>(gcode::readToolpath(
        "M83\nG1 Z.2\nG1 X100 E40 F600\n;LAYER:0\nG1 X110 E.4\nG1 X120 E.4\nG1 X130 E.4\nG1 X140 E.4\n", "test.gcode"));
    ASSERT_EQ(print->runOf(print->beads[0]).layer, 0U);
    const nlohmann::json printed = BeadTable(print).head()["printed"]["volume"];
    const std::size_t half = voxelize::parseSnapshots("50%", *print).front().bead_count;
    EXPECT_EQ(half, 3U);
    EXPECT_EQ(printed[99], half);
    EXPECT_EQ(printed[199], 5U);
}

TEST(BeadTable, RefusesWhatDoesNotFit) {
    gcode::Toolpath wide;
    wide.runs.emplace_back();
    wide.beads.emplace_back();
    wide.beads.back().width = 20.0F;
    EXPECT_THROW(BeadTable(std::make_shared<const gcode::Toolpath>(wide)), InputError);
    wide.beads.back().width = 0.4F;
    wide.runs.resize((1U << 19) + 1);
    EXPECT_THROW(BeadTable(std::make_shared<const gcode::Toolpath>(wide)), InputError);
}

}  // namespace
}  // namespace stratum::view
