#include "gcode/toolpath/color.h"

#include "gcode/program.h"

#include <gtest/gtest.h>

namespace stratum::gcode {
namespace {

using Color = std::array<std::uint8_t, 3>;

TEST(Color, SixDigits) {
    EXPECT_EQ(parseColor("#FF8000"), (Color{255, 128, 0}));
    EXPECT_EQ(parseColor("#0102feff"), (Color{1, 2, 254}));
    for (const auto* text : {"", "#", "#12345", "FF8000", "#GG0000", "#12 456", "#-10000"})
        EXPECT_FALSE(parseColor(text)) << text;
}

TEST(Color, ChangesByTheFile) {
    const Toolpath toolpath = readProgram(
        "M83\nG1 Z.2\nG1 X10 E1\n;COLOR_CHANGE,T0,#ED1C24\nM600\nG1 X0 "
        "E1\n;COLOR_CHANGE,T12,#000001\n");
    ASSERT_EQ(toolpath.color_changes.size(), 2U);
    EXPECT_EQ(toolpath.color_changes[0].first_bead, 1U);
    EXPECT_EQ(toolpath.color_changes[0].tool, 0);
    EXPECT_EQ(toolpath.color_changes[0].color, (Color{0xed, 0x1c, 0x24}));
    EXPECT_EQ(toolpath.color_changes[1].tool, 12);
}

}  // namespace
}  // namespace stratum::gcode
