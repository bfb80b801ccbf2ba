#include "gcode/toolpath/ramps.h"

#include "gcode/program.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

namespace stratum::gcode {
namespace {

constexpr double kWidth = 0.5;

double eOf(double width, double height, double length) { return sectionArea(width, height) * length / kFilamentArea; }

// A wall of two layers of 0.3 mm around a square of 20 mm; the second one climbs over `climb` mm of its first side, and
// ends above that.
std::string scarf(double climb, int pieces) {
    std::string text = "M83\n;LAYER_CHANGE\n;HEIGHT:0.3\n;TYPE:External perimeter\nG1 Z.3\n";
    const std::string side = fmt::format("E{:.6f}\n", eOf(kWidth, 0.3, 20));
    text += "G1 X20 " + side + "G1 Y20 " + side + "G1 X0 " + side + "G1 Y0 " + side;
    text += ";LAYER_CHANGE\n;HEIGHT:0.3\n;TYPE:External perimeter\nG1 X0 Y0\n";
    const double step = climb / pieces;
    for (int n = 0; n < pieces; ++n)
        text += fmt::format("G1 X{:.4f} Z{:.5f} E{:.6f}\n", (n + 1) * step, 0.3 + 0.3 * (n + 1) / pieces,
                            eOf(kWidth, 0.3 * (n + 0.5) / pieces, step));
    text += fmt::format("G1 X20 E{:.6f}\n", eOf(kWidth, 0.3, 20 - climb));
    text += "G1 Y20 " + side + "G1 X0 " + side + "G1 Y0 " + side;
    for (int n = 0; n < pieces; ++n)
        text += fmt::format("G1 X{:.4f} E{:.6f}\n", (n + 1) * step, eOf(kWidth, 0.3 * (1 - (n + 0.5) / pieces), step));
    return text;
}

TEST(Ramps, AScarfSeamIsAsWideAsItsWallAndAsHighAsItsPlace) {
    const Toolpath toolpath = readProgram(scarf(8, 10));
    EXPECT_NEAR(beadVolume(toolpath), toolpath.extruded_mm3, 1e-4 * toolpath.extruded_mm3);
    double ramp = 0;
    double gap = 0;
    for (const Bead& bead : toolpath.beads) {
        const double height = static_cast<double>(toolpath.runOf(bead).height);
        EXPECT_NEAR(static_cast<double>(bead.width), kWidth, 0.005);
        if (bead.z0 != bead.z1) {
            EXPECT_NEAR(height, 0.5 * (bead.z0 + bead.z1) - 0.3, 0.001);
            ramp += height * beadLength(toolpath, bead);
        } else if (height < 0.299) {
            EXPECT_EQ(bead.z1, 0.6);
            gap += height * beadLength(toolpath, bead);
        }
    }
    EXPECT_NEAR(ramp, 8 * 0.15, 0.01);
    EXPECT_NEAR(gap, 8 * 0.15, 0.01);
    EXPECT_EQ(toolpath.layer_count, 2U);
    EXPECT_TRUE(toolpath.warnings.empty());
}

TEST(Ramps, ASpiralsFirstTurnGrowsAndTheOthersStay) {
    std::string text = "M83\n;LAYER_CHANGE\n;HEIGHT:0.2\nG1 X10 Z.2\n";
    constexpr int kPieces = 36;
    const double chord = 2 * 10 * std::sin(std::numbers::pi / kPieces);
    const auto turn = [&](int n, double z, double e) {
        const double angle = 2 * std::numbers::pi * n / kPieces;
        text += fmt::format("G1 X{:.5f} Y{:.5f} Z{:.5f} E{:.6f}\n", 10 * std::cos(angle), 10 * std::sin(angle), z, e);
    };
    for (int n = 1; n <= kPieces; ++n) turn(n, 0.2, eOf(kWidth, 0.2, chord));
    for (int layer = 1; layer <= 3; ++layer) {
        text += ";LAYER_CHANGE\n;HEIGHT:0.2\n";
        for (int n = 1; n <= kPieces; ++n) {
            const double share = layer == 1 ? (n - 0.5) / kPieces : 1;
            turn(n, 0.2 * layer + 0.2 * n / kPieces, eOf(kWidth, 0.2 * share, chord));
        }
    }
    const Toolpath toolpath = readProgram(text);
    ASSERT_EQ(toolpath.beads.size(), 4U * kPieces);
    for (std::size_t n = 0; n < toolpath.beads.size(); ++n) {
        const auto height = static_cast<double>(toolpath.runOf(toolpath.beads[n]).height);
        const bool first_turn = n >= kPieces && n < 2U * kPieces;
        if (n == kPieces || n == kPieces + 1) continue;  // thinner than the 10 um of the thinnest bead
        EXPECT_NEAR(height, first_turn ? 0.2 * (static_cast<double>(n % kPieces) + 0.5) / kPieces : 0.2, 0.01) << n;
        EXPECT_NEAR(static_cast<double>(toolpath.beads[n].width), kWidth, 0.02) << n;
    }
}

TEST(Ramps, SlopesOfFullFlowStay) {
    // A non-planar top: the nozzle rises with the surface, and lays a whole layer everywhere.
    std::string text = "M83\n;LAYER_CHANGE\n;HEIGHT:0.2\nG1 Z.2\nG1 X20 E1\n;LAYER_CHANGE\n;HEIGHT:0.2\nG1 Z.3\n";
    for (int n = 19; n >= 0; --n)
        text += fmt::format("G1 X{} Z{:.3f} E{:.6f}\n", n, n > 9 ? 0.4 - 0.01 * (n - 10) : 0.4 - 0.01 * (10 - n),
                            eOf(kWidth, 0.2, 1));
    const Toolpath toolpath = readProgram(text);
    for (const Bead& bead : toolpath.beads) EXPECT_NEAR(static_cast<double>(toolpath.runOf(bead).height), 0.2, 1e-6);
}

TEST(Ramps, LongOnesTakeTimeInProportion) {
    // One slope and one level path of very many beads in the same layer.
    std::string text = "M83\n;LAYER_CHANGE\n;HEIGHT:0.2\nG1 Z.2\n";
    for (int n = 0; n < 30000; ++n) text += fmt::format("G1 X{} Z{:.7f} E.01\n", n % 2, 0.2 + 0.2 * n / 30000);
    for (int n = 0; n < 30000; ++n) text += fmt::format("G1 X{} E.001\n", n % 2);
    EXPECT_EQ(readProgram(text).beads.size(), 59999U);  // the first one moves nothing
}

}  // namespace
}  // namespace stratum::gcode
