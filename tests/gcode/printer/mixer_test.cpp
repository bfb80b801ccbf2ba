#include "gcode/printer/mixer.h"

#include "gcode/text/lexer.h"

#include <gtest/gtest.h>

#include <string>

namespace stratum::gcode {
namespace {

using Shares = std::vector<double>;

Command commandOf(const std::string& text) {
    static std::string kept;  // commands have views of it
    kept = text;
    Lexer lexer(kept);
    Line line;
    EXPECT_TRUE(lexer.next(line));
    EXPECT_EQ(line.count, 1U);
    return line.commands[0];
}

TEST(Mixer, FactorsBecomeSharesOfATool) {
    Mixer mixer;
    EXPECT_TRUE(mixer.setFactor(commandOf("M163 S0 P0.6")));
    EXPECT_TRUE(mixer.setFactor(commandOf("M163 S2 P1.8")));
    const auto mix = mixer.save(commandOf("M164 S5"), 0);
    ASSERT_TRUE(mix);
    EXPECT_EQ(mix->tool, 5);
    ASSERT_EQ(mix->shares.size(), 3U);
    EXPECT_NEAR(mix->shares[0], 0.25, 1e-12);
    EXPECT_EQ(mix->shares[1], 0);
    EXPECT_NEAR(mix->shares[2], 0.75, 1e-12);
    EXPECT_EQ(mixer.save(commandOf("M164"), 7)->tool, 7);
}

TEST(Mixer, AllAtOnce) {
    Mixer mixer;
    EXPECT_TRUE(mixer.setFactor(commandOf("M163 S3 P1")));
    const auto mix = mixer.setAll(commandOf("M165 A1 B3"), 2);
    ASSERT_TRUE(mix);
    EXPECT_EQ(mix->tool, 2);
    EXPECT_EQ(mix->shares, (Shares{0.25, 0.75}));  // the fourth is left out, and so is 0
}

TEST(Mixer, RepRapFirmwaresList) {
    const auto mix = Mixer::ofTool(commandOf("M567 P1 E0.1:0.1:0.2"), 0);
    ASSERT_TRUE(mix);
    EXPECT_EQ(mix->tool, 1);
    ASSERT_EQ(mix->shares.size(), 3U);
    EXPECT_NEAR(mix->shares[2], 0.5, 1e-12);
    EXPECT_FALSE(Mixer::ofTool(commandOf("M567 P1"), 0));
    EXPECT_FALSE(Mixer::ofTool(commandOf("M567 P1 Ex"), 0));
}

TEST(Mixer, WhatIsNoMixIsNone) {
    Mixer mixer;
    EXPECT_FALSE(mixer.save(commandOf("M164 S0"), 0));  // all 0
    EXPECT_FALSE(mixer.setAll(commandOf("M165"), 0));
    EXPECT_FALSE(mixer.setFactor(commandOf("M163 S99 P1")));
    EXPECT_FALSE(mixer.setFactor(commandOf("M163 S-1 P1")));
    EXPECT_TRUE(mixer.setFactor(commandOf("M163 S1 P-4")));
    EXPECT_FALSE(mixer.save(commandOf("M164 S0"), 0));
    EXPECT_TRUE(mixer.setFactor(commandOf("M163 S1 P4")));
    EXPECT_FALSE(mixer.save(commandOf("M164 S1000"), 0));
    EXPECT_TRUE(mixer.save(commandOf("M164 S254"), 0));
}

}  // namespace
}  // namespace stratum::gcode
