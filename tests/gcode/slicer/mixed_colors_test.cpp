#include "gcode/slicer/bead_colors.h"

#include "gcode/program.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

namespace stratum::gcode {
namespace {

constexpr Rgb kYellow{255, 255, 0};
constexpr Rgb kCyan{0, 255, 255};
constexpr Rgb kWhite{255, 255, 255};
constexpr Rgb kBlack{0, 0, 0};

Rgb mixed(const std::vector<Rgb>& colors, const std::vector<double>& shares) { return mixedColor(colors, shares); }

TEST(MixedColors, OneAloneStaysAsItIs) {
    EXPECT_EQ(mixed({{1, 2, 3}}, {1}), (Rgb{1, 2, 3}));
    EXPECT_EQ(mixed({{200, 100, 50}, {200, 100, 50}}, {0.3, 0.7}), (Rgb{200, 100, 50}));
}

TEST(MixedColors, YellowAndCyanMakeGreen) {
    const Rgb green = mixed({kYellow, kCyan}, {0.5, 0.5});
    EXPECT_LT(green[0], 60);
    EXPECT_GT(green[1], 240);
    EXPECT_LT(green[2], 60);
}

TEST(MixedColors, OfThePublishedFormula) {
    // R = 0.5 and R = 0.1, half of each: K/S = (0.25 + 4.05) / 2 = 2.15, R = 3.15 - sqrt(3.15^2 - 1).
    const auto byte = [](double linear) {
        return static_cast<std::uint8_t>(std::lround(255 * (1.055 * std::pow(linear, 1 / 2.4) - 0.055)));
    };
    const std::uint8_t half = byte(0.5);
    const std::uint8_t tenth = byte(0.1);
    const Rgb result = mixed({{half, half, half}, {tenth, tenth, tenth}}, {0.5, 0.5});
    EXPECT_NEAR(result[0], byte(3.15 - std::sqrt(3.15 * 3.15 - 1)), 1);
}

TEST(MixedColors, DarkStainsMoreThanLightDoes) {
    // A little black in white is far from white; a little white in black is almost black.
    EXPECT_LT(mixed({kWhite, kBlack}, {0.9, 0.1})[0], 110);
    EXPECT_LT(mixed({kWhite, kBlack}, {0.1, 0.9})[0], 40);
    int last = 256;
    for (int n = 0; n <= 10; ++n) {
        const int now = mixed({kWhite, kBlack}, {1 - n / 10.0, n / 10.0})[0];
        EXPECT_LT(now, last);
        last = now;
    }
}

ReadOptions withColors(std::vector<std::optional<Rgb>> colors) {
    ReadOptions options;
    options.filament_colors = std::move(colors);
    return options;
}

TEST(MixedColors, ToolsOfAProgram) {
    const std::string program =
        "M163 S0 P1\nM163 S1 P1\nM164 S2\nM83\nG1 Z.2\nT0\nG1 X10 E1\nT1\nG1 X20 E1\nT2\nG1 X30 E1\n"
        "M165 A1 B3\nG1 X40 E1\nT0\nG1 X50 E1\n";
    const Toolpath toolpath = readProgram(program, withColors({kYellow, kCyan}));
    ASSERT_EQ(toolpath.beads.size(), 5U);
    EXPECT_EQ(colorOf(toolpath, 0), kYellow);
    EXPECT_EQ(colorOf(toolpath, 1), kCyan);
    EXPECT_EQ(colorOf(toolpath, 2), mixed({kYellow, kCyan}, {0.5, 0.5}));
    EXPECT_EQ(colorOf(toolpath, 3), mixed({kYellow, kCyan}, {0.25, 0.75}));
    EXPECT_EQ(colorOf(toolpath, 4), kYellow);
    EXPECT_EQ(warningCount(toolpath, "mixes"), 0U);
    // Without them there is nothing to mix, and that is said once.
    const Toolpath bare = readProgram(program);
    EXPECT_TRUE(statedColorOf(bare, 2).palette);
    EXPECT_EQ(warningCount(bare, "mixes filaments"), 1U);
    // One filament's colour is missing.
    EXPECT_EQ(warningCount(readProgram(program, withColors({kYellow})), "more filaments than have a colour"), 1U);
}

TEST(MixedColors, AskedColorsStandBeforeTheFiles) {
    const std::string program = "M83\nG1 Z.2\nG1 X10 E1\nT1\nG1 X20 E1\n; filament_colour = #111111;#222222\n";
    const Toolpath toolpath = readProgram(program, withColors({std::nullopt, kCyan}));
    EXPECT_EQ(colorOf(toolpath, 0), (Rgb{0x11, 0x11, 0x11}));
    EXPECT_EQ(colorOf(toolpath, 1), kCyan);
}

TEST(MixedColors, RepRapFirmwareMixesByTool) {
    const std::string program = "M567 P0 E0.5:0.5\nM83\nG1 Z.2\nT0\nG1 X10 E1\n";
    ReadOptions options = withColors({kYellow, kCyan});
    EXPECT_EQ(colorOf(readProgram(program, options), 0), kYellow);  // Marlin has no such command
    options.firmware = Firmware::reprap;
    EXPECT_EQ(colorOf(readProgram(program, options), 0), mixed({kYellow, kCyan}, {0.5, 0.5}));
}

}  // namespace
}  // namespace stratum::gcode
