#include "study/picture/flip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace stratum::study {
namespace {

using shade::Color;

DisplayPicture filled(const Color& color, int side = 24) {
    DisplayPicture picture{side, side, {}};
    picture.pixels.assign(static_cast<std::size_t>(side * side), color);
    return picture;
}

DisplayPicture noisy(float amplitude, unsigned seed) {
    DisplayPicture picture = filled(Color(0.5f), 48);
    std::mt19937 random(seed);
    std::normal_distribution<float> normal(0.0f, amplitude);
    for (Color& c : picture.pixels)
        for (int k = 0; k < 3; ++k) c[k] = std::clamp(0.5f + normal(random), 0.0f, 1.0f);
    return picture;
}

TEST(Flip, OfEqualPicturesIsZero) { EXPECT_EQ(meanFlip(noisy(0.2f, 1), noisy(0.2f, 1)), 0); }

// The scale ends, by the paper's definition, at the primaries that are farthest from each other: green and blue.
TEST(Flip, OfGreenAndBlueIsOne) {
    EXPECT_NEAR(meanFlip(filled({0, 1, 0}), filled({0, 0, 1})), 1, 1e-5);
    for (const Color& other : {Color(1, 0, 0), Color(1, 1, 1), Color(0, 0, 0), Color(1, 1, 0)})
        EXPECT_LT(meanFlip(filled({0, 1, 0}), filled(other)), 1);
}

// Where nothing varies in space, all is colour and can be computed by hand. Greys have no chroma: HyAB is the
// difference of lightness. Black to white: 100^0.7 = 25.12; the largest is that of green (L* 87.735, a* -86.183,
// b* 83.180) and blue (32.297, 79.188, -107.858), Hunt-adjusted: 55.438 + |(-101.188, 107.815)| = 203.30;
// 203.30^0.7 = 41.28. Beyond the bend at 0.4 of that: 0.95 + 0.05 (25.12 - 16.51) / (41.28 - 16.51) = 0.9674.
TEST(Flip, OfPlainColorsIsKnown) {
    EXPECT_NEAR(meanFlip(filled(Color(0)), filled(Color(1))), 0.9674, 1e-4);
    // sRGB 0.5 is 0.2140 of white's light: L* = 53.389. Below the bend: 0.95 * 53.389^0.7 / 16.51 = 0.9312.
    EXPECT_NEAR(meanFlip(filled(Color(0)), filled(Color(0.5f))), 0.95 * std::pow(53.389, 0.7) / 16.511, 1e-3);
}

// What the authors' own program says of pictures by formula (github.com/NVlabs/flip, src/cpp/FLIP.h, version 1.6,
// LDR-FLIP): waves of light and colour, of three amplitudes and three wavelengths, seen from two distances.
TEST(Flip, HasTheValuesOfTheAuthorsProgram) {
    struct Value {
        double amplitude, frequency, pixels_per_degree, flip;
    };
    constexpr Value kValues[] = {
        {0.02, 0.15, 67.0206, 0.093879}, {0.02, 0.15, 20, 0.091657},   {0.02, 0.9, 67.0206, 0.051809},
        {0.02, 0.9, 20, 0.091241},       {0.02, 3, 67.0206, 0.003994}, {0.02, 3, 20, 0.073319},
        {0.1, 0.15, 67.0206, 0.296002},  {0.1, 0.15, 20, 0.285210},    {0.1, 0.9, 67.0206, 0.168043},
        {0.1, 0.9, 20, 0.288797},        {0.1, 3, 67.0206, 0.031353},  {0.1, 3, 20, 0.228003},
        {0.4, 0.15, 67.0206, 0.665084},  {0.4, 0.15, 20, 0.650249},    {0.4, 0.9, 67.0206, 0.431120},
        {0.4, 0.9, 20, 0.648967},        {0.4, 3, 67.0206, 0.209589},  {0.4, 3, 20, 0.549421}};
    for (const Value& value : kValues) {
        DisplayPicture reference{64, 48, {}};
        DisplayPicture picture = reference;
        for (int y = 0; y < reference.height; ++y)
            for (int x = 0; x < reference.width; ++x) {
                Color smooth;
                Color waved;
                for (int k = 0; k < 3; ++k) {
                    const double r = 0.5 + 0.3 * std::sin(0.21 * x + 0.13 * y + 1.7 * k);
                    const double phase = value.frequency * x + 0.6 * value.frequency * y + 2.3 * k;
                    smooth[k] = static_cast<float>(r);
                    waved[k] = static_cast<float>(
                        std::clamp(r + value.amplitude * std::sin(phase) * std::cos(0.05 * x), 0.0, 1.0));
                }
                reference.pixels.push_back(smooth);
                picture.pixels.push_back(waved);
            }
        EXPECT_NEAR(meanFlip(reference, picture, value.pixels_per_degree), value.flip, 2e-4)
            << value.amplitude << " " << value.frequency << " " << value.pixels_per_degree;
    }
}

TEST(Flip, IsSymmetricAndBetweenZeroAndOne) {
    const DisplayPicture a = noisy(0.3f, 1);
    const DisplayPicture b = noisy(0.3f, 2);
    const auto forth = flipMap(a, b);
    const auto back = flipMap(b, a);
    for (std::size_t n = 0; n < forth.size(); ++n) {
        EXPECT_NEAR(forth[n], back[n], 1e-6);
        EXPECT_GE(forth[n], 0.0f);
        EXPECT_LE(forth[n], 1.0f);
    }
}

TEST(Flip, GrowsWithNoise) {
    const DisplayPicture clean = filled(Color(0.5f), 48);
    double last = 0;
    for (const float amplitude : {0.01f, 0.03f, 0.1f, 0.3f}) {
        const double now = meanFlip(clean, noisy(amplitude, 3));
        EXPECT_GT(now, last * 1.3);
        last = now;
    }
}

// A checkerboard of single pixels is finer than the eye at 67 pixels a degree resolves, but not from ten times nearer:
// that is what the filters are for.
TEST(Flip, ForgivesWhatIsTooFineToBeSeen) {
    DisplayPicture board = filled(Color(0.5f), 64);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) board.pixels[static_cast<std::size_t>(64 * y + x)] = Color((x + y) % 2);
    // Of the same mean light as half of white: sRGB 0.7354.
    const DisplayPicture grey = filled(Color(0.735357f), 64);
    const double far = meanFlip(grey, board);
    const double near = meanFlip(grey, board, 0.1 * kFlipPixelsPerDegree);
    EXPECT_LT(far, 0.1);
    EXPECT_GT(near, 0.5);
}

// A feature that only one of the pictures has makes the same difference of colour worse.
TEST(Flip, SharpensDifferencesAtFeatures) {
    DisplayPicture line = filled(Color(0.5f), 65);
    for (int y = 0; y < 65; ++y)
        for (int x = 32; x < 65; ++x) line.pixels[static_cast<std::size_t>(65 * y + x)] = Color(0.6f);
    const auto map = flipMap(filled(Color(0.5f), 65), line);
    EXPECT_GT(map[65 * 32 + 33], map[65 * 32 + 60] * 1.05f);
    EXPECT_LT(map[65 * 32 + 5], 0.01f);
}

TEST(Flip, RefusesPicturesOfDifferentSizes) {
    EXPECT_THROW(meanFlip(filled(Color(0), 8), filled(Color(0), 9)), std::invalid_argument);
}

}  // namespace
}  // namespace stratum::study
