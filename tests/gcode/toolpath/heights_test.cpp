// Heights and places by whole programs: spirals, supports, ironing.
#include "gcode/toolpath/sections.h"

#include "gcode/program.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace stratum::gcode {
namespace {

// A round spiral of `turns` turns, 40 mm wide, that rises by pitch(turn) over each.
template <class Pitch>
std::string spiral(int turns, Pitch pitch) {
    std::string program = "M83\n";
    double z = pitch(0);
    program += fmt::format("G1 X20 Y0 Z{:.4f}\n", z);
    for (int turn = 0; turn < turns; ++turn)
        for (int i = 1; i <= 72; ++i) {
            const double angle = 2 * std::numbers::pi * i / 72;
            z += pitch(turn) / 72;
            program += fmt::format("G1 X{:.4f} Y{:.4f} Z{:.4f} E.1\n", 20 * std::cos(angle), 20 * std::sin(angle), z);
        }
    return program;
}

TEST(Heights, ASpiralsHeightIsItsRiseOverOneTurn) {
    const Toolpath toolpath = readProgram(spiral(20, [](int) { return 0.36; }));
    for (const Bead& bead : toolpath.beads)
        ASSERT_NEAR(static_cast<double>(toolpath.runOf(bead).height), 0.36, 0.01) << toolpath.lineOf(bead);
    EXPECT_NEAR(toolpath.layer_count, 20, 1);
    EXPECT_EQ(warningCount(toolpath, "doesn't tell its layer height"), 0U);
}

TEST(Heights, ASpiralMayChangeItsPitch) {
    const Toolpath toolpath = readProgram(spiral(40, [](int turn) { return turn < 20 ? 0.2 : 0.4; }));
    EXPECT_NEAR(static_cast<double>(toolpath.runOf(toolpath.beads[10 * 72]).height), 0.2, 0.02);
    EXPECT_NEAR(static_cast<double>(toolpath.runOf(toolpath.beads[35 * 72]).height), 0.4, 0.02);
}

TEST(Heights, ANearNominalSpiralIsNominal) {
    const Toolpath toolpath = readProgram("; layer_height = 0.3\n" + spiral(10, [](int) { return 0.298; }));
    for (const Bead& bead : toolpath.beads) ASSERT_FLOAT_EQ(toolpath.runOf(bead).height, 0.3F);
}

TEST(Heights, SupportsWithLayersOfTheirOwn) {
    // A part in layers of 0.2 beside a support in layers of 0.3.
    std::string program = "M83\n";
    for (int i = 1; i <= 30; ++i) {
        if (i % 2 == 0) program += fmt::format(";TYPE:FILL\nG1 X0 Y0 Z{:.1f}\nG1 X20 E1\n", 0.1 * i);
        if (i % 3 == 0) program += fmt::format(";TYPE:SUPPORT\nG1 X0 Y50 Z{:.1f}\nG1 X20 E1\n", 0.1 * i);
    }
    const Toolpath toolpath = readProgram(program);
    for (const Bead& bead : toolpath.beads)
        ASSERT_NEAR(static_cast<double>(toolpath.runOf(bead).height), bead.y0 > 0 ? 0.3 : 0.2, 1e-4) << bead.z0;
}

TEST(Heights, IroningIsAsThinAsItsMaterial) {
    const Toolpath toolpath = readProgram("M83\n;TYPE:Perimeter\nG1 Z.2\nG1 X50 E2\n;TYPE:Ironing\nG1 X0 E.1\n");
    const Bead& bead = toolpath.beads[1];
    const double diameter = 2 * std::sqrt(0.1 * kFilamentArea / 50 / std::numbers::pi);
    EXPECT_NEAR(static_cast<double>(toolpath.runOf(bead).height), diameter, 1e-6);
    EXPECT_NEAR(static_cast<double>(bead.width), diameter, 1e-6);
}

TEST(LocalRises, WhatLiesBelow) {
    Toolpath toolpath;
    const auto lay = [&](double x, double z, std::uint32_t layer) {
        Bead bead{.x0 = x, .z0 = z, .x1 = x + 20, .z1 = z};
        bead.run = static_cast<std::uint32_t>(toolpath.runs.size());
        toolpath.runs.push_back({.layer = layer});
        toolpath.beads.push_back(bead);
    };
    lay(0, 0.2, 1);
    lay(0, 0.5, 2);
    lay(0, 0.5, 2);    // a neighbour on the same level
    lay(10, 0.9, 3);   // half of it over nothing
    lay(100, 0.9, 3);  // all of it
    lay(0, 0.6, 0);    // a start-up line is no part of the print
    const auto rises = localRises(toolpath, std::vector<bool>(toolpath.runs.size(), true));
    EXPECT_EQ(rises[0].share, 0);
    EXPECT_NEAR(rises[1].median, 0.3, 1e-6);
    EXPECT_NEAR(rises[2].median, 0.3, 1e-6);
    EXPECT_NEAR(rises[3].median, 0.4, 1e-6);
    EXPECT_NEAR(rises[3].share, 0.5, 0.06);
    EXPECT_EQ(rises[4].share, 0);
    EXPECT_EQ(rises[5].share, 0);
}

TEST(Heights, IroningBelowTheBed) {
    const Toolpath toolpath =
        readProgram("M83\n;layer_height = 0.2\nG1 Z0\n;TYPE:Ironing\nG1 X9 E.01\nG1 Z-.1\nG1 X0 E.01\n");
    for (const Bead& bead : toolpath.beads) EXPECT_GT(toolpath.runOf(bead).height, 0.009F);
    EXPECT_GT(warningCount(toolpath, "at or below the bed"), 0U);
}

}  // namespace
}  // namespace stratum::gcode
