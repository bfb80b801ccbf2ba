#include "shade/film/legend.h"

#include "shade/palette/filament_color.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>

namespace stratum {
namespace {

using shade::Color;
using shade::Legend;

constexpr int kPictureWidth = 320;
constexpr int kPictureHeight = 240;

std::vector<std::uint8_t> drawn(const Legend& legend, int width = kPictureWidth, int height = kPictureHeight) {
    std::vector<std::uint8_t> rgb(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 40);
    shade::draw(legend, width, height, rgb);
    return rgb;
}

/// Pixels of about this colour.
int countOf(const std::vector<std::uint8_t>& rgb, const std::array<int, 3>& color) {
    int count = 0;
    for (std::size_t n = 0; n < rgb.size(); n += 3)
        if (std::abs(rgb[n] - color[0]) <= 1 && std::abs(rgb[n + 1] - color[1]) <= 1 &&
            std::abs(rgb[n + 2] - color[2]) <= 1)
            ++count;
    return count;
}

TEST(Legend, ShowsEachColorAndLeavesTheRestOfThePictureAlone) {
    Legend legend;
    legend.title = "tool";
    legend.entries = {{"tool 0", *shade::parseNamedColor("#1F4E6B")}, {"tool 1", *shade::parseNamedColor("#F2B33D")}};
    const auto rgb = drawn(legend);
    EXPECT_GT(countOf(rgb, {0x1f, 0x4e, 0x6b}), 40);
    EXPECT_GT(countOf(rgb, {0xf2, 0xb3, 0x3d}), 40);
    EXPECT_GT(countOf(rgb, {40, 40, 40}), kPictureWidth * kPictureHeight * 3 / 4);
    // The letters.
    EXPECT_GT(countOf(rgb, {33, 33, 33}), 10);
}

TEST(Legend, ShowsARamp) {
    Legend legend;
    legend.title = "speed";
    legend.unit = "mm/s";
    legend.least = 12.5;
    legend.most = 80;
    legend.ramp = {*shade::parseNamedColor("#ff0000"), *shade::parseNamedColor("#00ff00"),
                   *shade::parseNamedColor("#0000ff")};
    const auto rgb = drawn(legend);
    for (const std::array<int, 3>& color : {std::array<int, 3>{255, 0, 0}, {0, 255, 0}, {0, 0, 255}})
        EXPECT_GT(countOf(rgb, color), 100);
}

TEST(Legend, LeavesSmallPicturesVisible) {
    Legend legend;
    legend.title = "feature";
    for (const char* name : {"outer wall", "inner wall", "overhang wall", "solid infill", "sparse infill",
                             "top surface", "bottom surface", "bridge", "gap infill", "skirt"})
        legend.entries.push_back({name, Color(0.5f)});
    const auto hidden = [&legend](int width, int height) {
        const auto rgb = drawn(legend, width, height);
        return 1.0 - countOf(rgb, {40, 40, 40}) / (1.0 * width * height);
    };
    EXPECT_LT(hidden(kPictureWidth, kPictureHeight), 0.14);
    EXPECT_GT(hidden(kPictureWidth, kPictureHeight), 0.05);
    EXPECT_LT(hidden(640, 480), 0.125);
}

TEST(Legend, FitsIntoSmallPicturesAndLongLists) {
    Legend legend;
    legend.title = "object";
    for (int n = 0; n < 64; ++n) legend.entries.push_back({"object " + std::to_string(n), Color(0.5f)});
    drawn(legend);
    drawn(legend, 16, 16);
    drawn(legend, 1, 1);
    legend.entries.clear();
    drawn(legend, 3, 2);
}

}  // namespace
}  // namespace stratum
