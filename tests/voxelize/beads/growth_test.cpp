#include "voxelize/beads/growth.h"

#include "base/input_file.h"
#include "corpus.h"
#include "gcode/reader.h"
#include "toolpaths.h"
#include "voxelize/beads/selection.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace stratum::voxelize {
namespace {

using Moments = std::vector<std::uint32_t>;

Moments momentsOf(const gcode::Toolpath& toolpath, const Moments& beads, std::size_t count, GrowthBy by) {
    return growthMoments(toolpath, beads, {by, equalShares(count)});
}

/// Four beads of 10 mm, the last one twice as wide.
gcode::Toolpath fourBeads() {
    gcode::Toolpath toolpath;
    for (int n = 0; n < 4; ++n) test::addBead(toolpath, 0, n, 0.2, 10, n, 0.2, n == 3 ? 0.8 : 0.4, 0.2);
    return toolpath;
}

TEST(Growth, ByVolume) {
    const gcode::Toolpath toolpath = fourBeads();
    EXPECT_EQ(momentsOf(toolpath, test::allBeads(toolpath), 1, GrowthBy::volume), Moments{4});
    // 0.4 wide is 0.0714 mm2, 0.8 is 0.1514: shares of the sum are 0.195, 0.390, 0.586, 1.
    EXPECT_EQ(momentsOf(toolpath, test::allBeads(toolpath), 5, GrowthBy::volume), (Moments{2, 3, 4, 4, 4}));
    EXPECT_EQ(momentsOf(toolpath, Moments{1, 2}, 4, GrowthBy::volume), (Moments{2, 2, 3, 3}));
}

TEST(Growth, ByTimeStandsStillWhileTheMachineTravels) {
    gcode::Toolpath toolpath = fourBeads();
    // 1 s each; 5 s of travel after the second.
    for (const double start : {10.0, 11.0, 17.0, 18.0}) toolpath.timing.push_back({start, 1.0F, 0, 0, 0});
    EXPECT_EQ(momentsOf(toolpath, test::allBeads(toolpath), 9, GrowthBy::time), (Moments{1, 2, 2, 2, 2, 2, 2, 3, 4}));
    EXPECT_EQ(momentsOf(toolpath, Moments{2, 3}, 2, GrowthBy::time), (Moments{3, 4}));
    // The first bead is there from the first moment, though it is not finished.
    EXPECT_EQ(momentsOf(toolpath, test::allBeads(toolpath), 18, GrowthBy::time).front(), 1u);
}

TEST(Growth, WithoutTimesBySpeedAndWithoutSpeedsByVolume) {
    gcode::Toolpath toolpath = fourBeads();
    const auto volume = momentsOf(toolpath, test::allBeads(toolpath), 5, GrowthBy::volume);
    EXPECT_EQ(momentsOf(toolpath, test::allBeads(toolpath), 5, GrowthBy::time), volume);
    for (gcode::Run& run : toolpath.runs) run.speed = 20;
    EXPECT_EQ(momentsOf(toolpath, test::allBeads(toolpath), 4, GrowthBy::time), (Moments{1, 2, 3, 4}));
}

TEST(Growth, ByLayersEachLayerTakesTheSameShare) {
    gcode::Toolpath toolpath;
    // A layer of six beads and two of one, of the next part again one.
    for (int n = 0; n < 9; ++n) test::addBead(toolpath, 0, n, 0.2, 10, n, 0.2, 0.4, 0.2);
    for (std::size_t n = 0; n < 9; ++n) {
        if (n >= toolpath.runs.size()) toolpath.runs.push_back(toolpath.runs.back());
        toolpath.beads[n].run = static_cast<std::uint32_t>(n);
        toolpath.runs[n].layer = n < 6 ? 1 : n < 7 ? 2 : n < 8 ? 3 : 1;
    }
    EXPECT_EQ(momentsOf(toolpath, test::allBeads(toolpath), 4, GrowthBy::layers), (Moments{6, 7, 8, 9}));
    EXPECT_EQ(momentsOf(toolpath, test::allBeads(toolpath), 8, GrowthBy::layers), (Moments{3, 6, 6, 7, 7, 8, 8, 9}));
    // Within a layer by time.
    for (int n = 0; n < 9; ++n) toolpath.timing.push_back({n < 5 ? 1.0 * n : 15.0 + n, 1.0F, 0, 0, 0});
    EXPECT_EQ(momentsOf(toolpath, test::allBeads(toolpath), 8, GrowthBy::layers), (Moments{5, 6, 6, 7, 7, 8, 8, 9}));
}

TEST(Growth, SharesMayStandStillAtTheEnd) {
    const gcode::Toolpath toolpath = fourBeads();
    EXPECT_EQ(growthMoments(toolpath, test::allBeads(toolpath), {GrowthBy::volume, {0.1, 0.5, 1, 1}}),
              (Moments{1, 3, 4, 4}));
}

TEST(Growth, IsThatOfSnapshots) {
    const InputFile file(test::dataDir() / "gcode/tile.gcode");
    const gcode::Toolpath toolpath = gcode::readToolpath(file.bytes(), "tile.gcode", {});
    constexpr std::size_t kSteps = 8;
    for (const auto by : {GrowthBy::volume, GrowthBy::time}) {
        // Shares of the volume leave prime lines out.
        const Moments beads = by == GrowthBy::volume ? selectBeads(toolpath, {}) : test::allBeads(toolpath);
        const Moments moments = momentsOf(toolpath, beads, kSteps, by);
        ASSERT_EQ(moments.size(), kSteps);
        EXPECT_TRUE(std::is_sorted(moments.begin(), moments.end()));
        for (std::size_t n = 0; n < kSteps; ++n) {
            const std::string text =
                fmt::format("{}{}%", by == GrowthBy::time ? "time:" : "", 100.0 * static_cast<double>(n + 1) / kSteps);
            EXPECT_EQ(moments[n], parseSnapshots(text, toolpath).front().bead_count) << text;
        }
    }
}

}  // namespace
}  // namespace stratum::voxelize
