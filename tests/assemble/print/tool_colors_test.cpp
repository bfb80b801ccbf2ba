#include "assemble/print/print_colors.h"

#include "base/error.h"

#include <gtest/gtest.h>

#include <string>

namespace stratum::assemble {
namespace {

using gcode::Rgb;

TEST(ToolColors, AListByTool) {
    const ToolColors colors = toolColorsOf("teal, #102030,,3DJAKE Silk Gold", "--color");
    ASSERT_EQ(colors.colors.size(), 4U);
    EXPECT_EQ(colors.colors[0], (Rgb{0, 0x80, 0x80}));
    EXPECT_EQ(colors.colors[1], (Rgb{0x10, 0x20, 0x30}));
    EXPECT_EQ(colors.colors[2], std::nullopt);
    EXPECT_EQ(colors.colors[3], (Rgb{0xc4, 0x99, 0x54}));
    ASSERT_EQ(colors.finishes.size(), 1U);
    EXPECT_TRUE(colors.finishes.at("#c49954").starts_with("silk:"));
}

TEST(ToolColors, SlipsNameTheOption) {
    try {
        (void)toolColorsOf("red,no such colour", "--color");
        ADD_FAILURE();
    } catch (const UsageError& error) {
        EXPECT_EQ(std::string(error.what()).find("--color no such colour"), 0U) << error.what();
    }
    EXPECT_THROW((void)toolColorsOf(std::string(300, ','), "--color"), UsageError);
}

}  // namespace
}  // namespace stratum::assemble
