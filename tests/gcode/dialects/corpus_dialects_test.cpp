// What single files of the corpus teach about their dialect.
#include "base/input_file.h"
#include "corpus.h"
#include "gcode/program.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace stratum::gcode {
namespace {

TEST(CorpusDialects, KiriMotosRelativeEIsFoundInTheNumbers) {
    // No M82, no M83: the printer's start macro holds it. The footer says 225.03 mm.
    STRATUM_NEEDS_CORPUS(path, "gcode/preprocess_cancellation-kirimoto.gcode");
    const InputFile file(path);
    const Toolpath toolpath = readToolpath(file.bytes(), "kirimoto");
    EXPECT_NEAR(toolpath.filament_mm, 225.03, 1e-3 * 225.03);
    EXPECT_EQ(warningCount(toolpath, "E keeps falling back"), 1U);
    EXPECT_EQ(toolpath.layer_count, 25U);
}

TEST(CorpusDialects, IdeaMakersFooterCountsTheCompensationTwice) {
    // Its E is nominal: width x height of the tags, as a rectangle, is what E comes to. "M221 T0 S94" (Filament
    // Compensation #1: 94) makes the printer push 94 % of that. The footer, 422.7 mm, is 94 % of 94 % of the E of what
    // the slicer itself lays (all but the start script's purge of 1 mm on the move).
    STRATUM_NEEDS_CORPUS(path, "gcode/preprocess_cancellation-ideamaker.gcode");
    const InputFile file(path);
    const Toolpath toolpath = readToolpath(file.bytes(), "ideamaker");
    EXPECT_NEAR(toolpath.filament_mm, 479.4152, 1e-3);
    EXPECT_NEAR(toolpath.extruded_mm3, 0.94 * 479.4152 * kFilamentArea, 0.01);
    EXPECT_NEAR((toolpath.filament_mm - 1) * 0.94 * 0.94, 422.7, 0.05);
    EXPECT_EQ(toolpath.objects.size(), 5U);
}

TEST(CorpusDialects, TheRippleVasesPitchIsMeasured) {
    // No tags, no settings, z on every move: 166.3 turns about its middle from z = 0.29 to 60.04, 0.36 mm each.
    STRATUM_NEEDS_CORPUS(path, "gcode/gcode-preview-ripple_vase.gcode");
    const InputFile file(path);
    const Toolpath toolpath = readToolpath(file.bytes(), "ripple_vase");
    EXPECT_NEAR(toolpath.filament_mm, 9535, 1);
    EXPECT_NEAR(toolpath.layer_count, 167, 2);
    for (const Bead& bead : toolpath.beads) {
        if (bead.z0 == bead.z1) continue;
        ASSERT_NEAR(static_cast<double>(toolpath.runOf(bead).height), 0.36, 0.01) << toolpath.lineOf(bead);
    }
    EXPECT_TRUE(toolpath.warnings.empty());
}

class CutShort : public testing::TestWithParam<const char*> {};

TEST_P(CutShort, IsNeverSilent) {
    STRATUM_NEEDS_CORPUS(path, std::string("gcode/") + GetParam());
    const InputFile file(path);
    const std::string_view whole = file.bytes();
    const Toolpath expected = readToolpath(whole, "whole");
    EXPECT_EQ(warningCount(expected, "cut short"), 0U);
    std::mt19937 random(3);
    for (int i = 0; i < 100; ++i) {
        const std::size_t size = random() % whole.size();
        try {
            const Toolpath toolpath = readToolpath(whole.substr(0, size), "cut");
            if (warningCount(toolpath, "cut short") > 0) continue;
            EXPECT_EQ(toolpath.beads.size(), expected.beads.size()) << size;
            EXPECT_NEAR(toolpath.extruded_mm3, expected.extruded_mm3, 1e-9) << size;
        } catch (const InputError&) {
        }
    }
}

INSTANTIATE_TEST_SUITE_P(
    Files, CutShort,
    testing::Values("preprocess_cancellation-cura.gcode", "preprocess_cancellation-superslicer.gcode",
                    "preprocess_cancellation-prusaslicer.gcode", "preprocess_cancellation-slic3r.gcode",
                    "preprocess_cancellation-ideamaker.gcode", "preprocess_cancellation-kirimoto.gcode",
                    "filaswitch-mc_testmodel1_S3D.gcode", "vase_ps25.gcode", "libbgcode-mini_cube_a.gcode"));

}  // namespace
}  // namespace stratum::gcode
