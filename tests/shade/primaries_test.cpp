#include "shade/primaries.h"

#include <gtest/gtest.h>

#include <array>

namespace stratum::shade {
namespace {

TEST(Primaries, XyzOfDaylightIsWhite) {
    const glm::dvec3 white = fromXyz(0.9505, 1.0, 1.089);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(white[c], 1.0, 1e-3);
}

TEST(Primaries, OwnOnesNeedNothing) {
    EXPECT_FALSE(toRec709({}).has_value());
    EXPECT_FALSE(toRec709({{0.640, 0.330}, {0.300, 0.600}, {0.150, 0.060}, {0.3127, 0.3290}}).has_value());
}

// ITU-R BT.2087, table of the conversion from BT.2020 to BT.709, by rows.
TEST(Primaries, AgreesWithTheStandardForBt2020) {
    const auto matrix = toRec709({{0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, {0.3127, 0.3290}});
    ASSERT_TRUE(matrix.has_value());
    const std::array<std::array<double, 3>, 3> standard{
        {{1.6605, -0.5876, -0.0728}, {-0.1246, 1.1329, -0.0083}, {-0.0182, -0.1006, 1.1187}}};
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 3; ++column)
            EXPECT_NEAR((*matrix)[static_cast<int>(column)][static_cast<int>(row)], standard[row][column], 1e-4);
}

// ACES2065-1: its white, D60, stays white.
TEST(Primaries, WhiteStaysWhite) {
    const auto matrix = toRec709({{0.7347, 0.2653}, {0.0, 1.0}, {0.0001, -0.077}, {0.32168, 0.33767}});
    ASSERT_TRUE(matrix.has_value());
    const glm::dvec3 white = *matrix * glm::dvec3(1.0);
    for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(white[channel], 1.0, 1e-9);
    // S-2008-001 and ISO 11664 by way of Bradford: the first row that OpenColorIO has for it.
    EXPECT_NEAR((*matrix)[0][0], 2.5217, 1e-3);
    EXPECT_NEAR((*matrix)[1][0], -1.1341, 1e-3);
    EXPECT_NEAR((*matrix)[2][0], -0.3876, 1e-3);
    std::array<Color, 1> green{Color(0.0f, 1.0f, 0.0f)};
    convert(green, *matrix);
    EXPECT_EQ(green[0].r, 0.0f);  // it lies outside
    EXPECT_GT(green[0].g, 0.5f);
}

TEST(Primaries, NonsenseIsLeftAlone) {
    EXPECT_FALSE(toRec709({{0.3, 0.3}, {0.3, 0.3}, {0.3, 0.3}, {0.3, 0.3}}).has_value());
    EXPECT_FALSE(toRec709({{0.64, 0.0}, {0.3, 0.6}, {0.15, 0.06}, {0.3127, 0.329}}).has_value());
}

}  // namespace
}  // namespace stratum::shade
