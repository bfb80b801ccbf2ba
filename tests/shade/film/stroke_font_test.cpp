#include "shade/film/stroke_font.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

namespace stratum {
namespace {

using shade::Canvas;
using shade::Color;

std::vector<std::uint8_t> written(const std::string& text, float capital) {
    std::vector<std::uint8_t> rgb(3 * 60 * 30, 255);
    Canvas canvas{60, 30, rgb};
    shade::drawText(canvas, 5, 20, capital, text, Color(0.0f));
    return rgb;
}

TEST(StrokeFont, EveryCharacterLooksDifferent) {
    std::set<std::string> seen;
    for (char c = '!'; c <= '~'; ++c) {
        const std::vector<std::uint8_t> rgb = written(std::string(1, c), 12);
        EXPECT_TRUE(seen.emplace(rgb.begin(), rgb.end()).second) << c;
    }
}

TEST(StrokeFont, StaysWithinItsWidth) {
    for (const char* text : {"m", "feature", "18.5 mm/s", "WWW"}) {
        std::vector<std::uint8_t> rgb(3 * 400 * 40, 255);
        Canvas canvas{400, 40, rgb};
        shade::drawText(canvas, 10, 25, 12, text, Color(0.0f));
        int first = 400;
        int last = 0;
        for (int y = 0; y < 40; ++y)
            for (int x = 0; x < 400; ++x)
                if (rgb[3 * static_cast<std::size_t>(y * 400 + x)] < 128) {
                    first = std::min(first, x);
                    last = std::max(last, x);
                }
        const float width = shade::textWidth(text, 12);
        EXPECT_GE(first, 9) << text;
        EXPECT_LE(last, 10 + width + 1) << text;
        EXPECT_GE(last, 10 + width - 4) << text;
    }
}

TEST(StrokeFont, TakesOtherCharactersForQuestionMarks) {
    EXPECT_EQ(written("\xc3\xa9", 12), written("?", 12));
    EXPECT_FLOAT_EQ(shade::textWidth("\xe2\x82\xac", 12), shade::textWidth("?", 12));
}

TEST(StrokeFont, DrawsNothingOutsideOfThePicture) {
    std::vector<std::uint8_t> rgb(3 * 4 * 4, 255);
    Canvas canvas{4, 4, rgb};
    shade::drawText(canvas, -50, 2, 40, "outside all around", Color(0.0f));
    canvas.fill(-10, -10, 50, 50, Color(0.5f));
    EXPECT_EQ(rgb[0], 128);
}

}  // namespace
}  // namespace stratum
