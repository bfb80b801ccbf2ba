#include "gcode/toolpath/sections.h"

#include "gcode/program.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

namespace stratum::gcode {
namespace {

// One 10 mm bead of 1 mm^2 at each (z, layer, tagged height) given.
struct Level {
    double z;
    std::uint32_t layer = 1;
    float height = 0;
    bool sloped = false;
};

struct Resolved {
    Toolpath toolpath;
    std::vector<Warning> warnings;
    float height(std::size_t i) const { return toolpath.runOf(toolpath.beads[i]).height; }
};

Resolved resolve(const std::vector<Level>& levels, std::optional<double> nominal) {
    Resolved resolved;
    std::vector<double> run_z;
    for (const Level& level : levels) {
        Bead bead{.x1 = 10, .z1 = level.z, .width = 1.0F};
        bead.z0 = level.sloped ? level.z - 0.1 : level.z;
        bead.run = static_cast<std::uint32_t>(run_z.size());
        resolved.toolpath.beads.push_back(bead);
        resolved.toolpath.runs.push_back({.height = level.height, .layer = level.layer});
        run_z.push_back(level.sloped ? std::numeric_limits<double>::quiet_NaN() : level.z);
    }
    WarningLog log;
    resolveSections(resolved.toolpath, run_z, nominal, log);
    resolved.warnings = log.take();
    return resolved;
}

TEST(Sections, HeightIsTheDistanceToTheNextLowerLevel) {
    const Resolved resolved = resolve({{0.6}, {1.0, 2}, {1.4, 3}, {1.2, 4}}, 0.4);
    EXPECT_FLOAT_EQ(resolved.height(0), 0.6F);
    EXPECT_FLOAT_EQ(resolved.height(1), 0.4F);
    EXPECT_FLOAT_EQ(resolved.height(2), 0.4F);  // nothing lies at 1.2 yet
    EXPECT_FLOAT_EQ(resolved.height(3), 0.2F);
    EXPECT_TRUE(resolved.warnings.empty());
}

TEST(Sections, ATagWins) {
    const Resolved resolved = resolve({{0.3, 1, 0.25F}, {0.5, 2}}, 0.2);
    EXPECT_FLOAT_EQ(resolved.height(0), 0.25F);
    EXPECT_FLOAT_EQ(resolved.height(1), 0.2F);
}

TEST(Sections, StartUpLinesRestOnTheBedAndAreNoLevels) {
    const Resolved resolved = resolve({{0.28, 0}, {5, 0}, {0.3, 1}}, 0.2);
    EXPECT_FLOAT_EQ(resolved.height(0), 0.28F);
    EXPECT_FLOAT_EQ(resolved.height(1), 0.2F);  // 5 mm is no bead's height: the nominal one
    EXPECT_FLOAT_EQ(resolved.height(2), 0.3F);
}

TEST(Sections, SlopedBeadsHaveTheNominalHeight) {
    EXPECT_FLOAT_EQ(resolve({{1.0, 1, 0, true}}, 0.3).height(0), 0.3F);
    const Resolved unknown = resolve({{1.0, 1, 0, true}}, std::nullopt);
    EXPECT_FLOAT_EQ(unknown.height(0), 0.2F);
    ASSERT_EQ(unknown.warnings.size(), 1U);
    EXPECT_NE(unknown.warnings[0].text.find("--layer-height"), std::string::npos);
}

// Layers of a spiral are counted by its height: many vectors have a place for each.
TEST(Sections, ASpiralHasNoMoreLayersThanBeads) {
    std::string text = "M83\nG1 X10 Y0 Z0.011\n";
    for (int n = 1; n <= 600; ++n)
        text += fmt::format("G1 X{:.4f} Y{:.4f} Z{:.6f} E0.002\n", 10 * std::cos(n * 0.105), 10 * std::sin(n * 0.105),
                            0.011 + n * 0.000183);
    for (int n = 0; n < 5; ++n)
        text += fmt::format("G1 X-95000 Y{0} Z1\nG1 X-94990 Y{0} Z1 E1\nG1 X95000 Y{0} Z99000 E4000\n", n + 107);
    const Toolpath toolpath = readProgram(text);
    EXPECT_LE(toolpath.layer_count, toolpath.beads.size());
}

TEST(Sections, ImpossibleHeightsFallBackWithAWarning) {
    const Resolved resolved = resolve({{0, 1}, {0.2, 2}, {9, 3}}, 0.2);
    EXPECT_FLOAT_EQ(resolved.height(0), 0.2F);
    EXPECT_FLOAT_EQ(resolved.height(2), 0.2F);
    EXPECT_EQ(resolved.warnings.size(), 2U);
    EXPECT_FLOAT_EQ(resolve({{3}}, std::nullopt).height(0), 3.0F);  // concrete is printed so
}

TEST(Sections, WidthHoldsTheArea) {
    const Resolved resolved = resolve({{2}, {4, 2}}, std::nullopt);
    const Bead& bead = resolved.toolpath.beads[0];
    // 1 mm^2 at 2 mm is less than a disc of that diameter (pi mm^2): round.
    EXPECT_NEAR(static_cast<double>(bead.width), 2 / std::sqrt(std::numbers::pi), 1e-6);
    EXPECT_NEAR(beadVolume(resolved.toolpath), 20, 1e-5);
    const Resolved flat = resolve({{0.5}}, std::nullopt);
    EXPECT_NEAR(static_cast<double>(flat.toolpath.beads[0].width), 2 + 0.5 * (1 - std::numbers::pi / 4), 1e-6);
}

TEST(Sections, AWidthBeyondReasonIsCutWithItsLine) {
    // 50 mm of 1.75 filament in 10 mm at 0.2: 60 mm wide.
    const Toolpath toolpath = readProgram("G1 Z0.2\nG1 X40 E400\n");
    ASSERT_EQ(toolpath.beads.size(), 1U);
    EXPECT_FLOAT_EQ(toolpath.beads[0].width, 20.0F);
    EXPECT_EQ(warningCount(toolpath, "wider than 100 layer heights"), 1U);
    for (const Warning& warning : toolpath.warnings)
        if (warning.text.find("wider") != std::string::npos) {
            EXPECT_EQ(warning.first_line, 2U);
        }
    // Of 400 mm of filament, a bead 20 mm wide and 40 mm long holds 160 mm^3 less its rounded sides.
    const double left = 400 * kFilamentArea - beadVolume(toolpath);
    EXPECT_EQ(warningCount(toolpath, fmt::format("{:.4g} mm^3 that were fed are in no bead", left)), 1U);
}

TEST(Sections, ABlobIsADiscOfItsVolume) {
    const Toolpath toolpath = readProgram("G1 Z0.2\nG1 X0.1 E1\nG1 X20 E1.5\n");
    ASSERT_EQ(toolpath.beads.size(), 2U);
    EXPECT_NEAR(static_cast<double>(toolpath.beads[0].width), 2 * std::sqrt(kFilamentArea / (std::numbers::pi * 0.2)),
                1e-5);
    EXPECT_EQ(warningCount(toolpath, "blob"), 1U);
}

}  // namespace
}  // namespace stratum::gcode
