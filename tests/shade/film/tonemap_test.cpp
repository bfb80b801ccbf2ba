#include "shade/film/tonemap.h"

#include "base/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace stratum {
namespace {

using shade::Color;
using shade::Film;
using shade::FilmContent;

TEST(ToneMapNeutral, KnownValues) {
    // Below the shoulder only the 4 % of Fresnel is taken away.
    EXPECT_NEAR(shade::toneMapNeutral(Color(0.5f)).r, 0.46f, 1e-6f);
    EXPECT_NEAR(shade::toneMapNeutral(Color(0.04f)).r, 6.25f * 0.04f * 0.04f, 1e-6f);
    EXPECT_EQ(shade::toneMapNeutral(Color(0.0f)), Color(0.0f));
    // 1 - 0.24^2 / (1.96 + 0.24 - 0.76)
    EXPECT_NEAR(shade::toneMapNeutral(Color(2.0f)).r, 1.0f - 0.0576f / 1.44f, 1e-5f);
    const Color red = shade::toneMapNeutral(Color(0.6f, 0.1f, 0.1f));
    EXPECT_NEAR(red.r, 0.56f, 1e-6f);
    EXPECT_NEAR(red.g, 0.06f, 1e-6f);
}

TEST(ToneMapNeutral, RisesAndStaysInRange) {
    float before = -1.0f;
    for (float v = 0.0f; v < 1e6f; v = v * 1.02f + 1e-4f) {
        const float r = shade::toneMapNeutral(Color(v)).r;
        ASSERT_GE(r, before) << v;
        ASSERT_LE(r, 1.0f);
        before = r;
    }
}

TEST(EncodeSrgb, KnownValues) {
    EXPECT_EQ(shade::encodeSrgb(-1.0f), 0.0f);
    EXPECT_EQ(shade::encodeSrgb(std::numeric_limits<float>::quiet_NaN()), 0.0f);
    EXPECT_NEAR(shade::encodeSrgb(0.002f), 0.02584f, 1e-6f);
    EXPECT_NEAR(shade::encodeSrgb(0.5f), 0.735357f, 1e-5f);
    EXPECT_NEAR(shade::encodeSrgb(1.0f), 1.0f, 1e-6f);
}

Film flat(const Color& c, FilmContent content, float alpha = 1.0f) {
    Film film(8, 8, {0, 0, 8, 8}, content);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) film.at(x, y) = {c, alpha};
    return film;
}

TEST(ToDisplay, DithersLightByHalfAStepAndAlwaysTheSame) {
    const Film film = flat(Color(0.5f), FilmContent::radiance);
    const auto bytes = shade::toDisplay(film);
    ASSERT_EQ(bytes.size(), 192u);
    const double exact = 255.0 * double(shade::encodeSrgb(0.46f));
    double mean = 0.0;
    for (const auto b : bytes) {
        EXPECT_NEAR(b, exact, 1.0);
        mean += b / 192.0;
    }
    EXPECT_NEAR(mean, exact, 0.15);
    EXPECT_EQ(bytes, shade::toDisplay(film));
    // One stop up.
    EXPECT_EQ(shade::toDisplay(flat(Color(0.25f), FilmContent::radiance), {.exposure = 1.0}), bytes);
}

TEST(ToDisplay, SurvivesNumbersThatAreNone) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    for (const FilmContent content :
         {FilmContent::radiance, FilmContent::unit, FilmContent::normal, FilmContent::depth})
        for (const float v : {nan, inf, -inf, 1e38f, -1.0f})
            EXPECT_EQ(shade::toDisplay(flat(Color(v), content)).size(), 192u);
}

TEST(ToDisplay, ShowsGeometry) {
    const auto normals = shade::toDisplay(flat(Color(0.0f, 1.0f, -1.0f), FilmContent::normal));
    EXPECT_EQ(normals[0], 128);
    EXPECT_EQ(normals[1], 255);
    EXPECT_EQ(normals[2], 0);
    Film depth = flat(Color(10.0f), FilmContent::depth);
    depth.at(1, 0) = {Color(20.0f), 1.0f};
    depth.at(2, 0) = {Color(0.0f), 0.0f};
    const auto bytes = shade::toDisplay(depth);
    EXPECT_EQ(bytes[0], 255);
    EXPECT_EQ(bytes[3], 26);
    EXPECT_EQ(bytes[6], 0);
}

// What a browser makes of the four bytes, over a backdrop of the encoded value b, beside what light gives.
TEST(ToDisplayWithAlpha, LaidOverAPageByEncodedValuesIsWhatLightGives) {
    const auto linear = [](double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); };
    struct Case {
        Color color;  // of what is there
        float alpha;
        double error;  // at most, of 255
    };
    for (const Case& c : {Case{Color(0.0f), 0.1f, 2.0},
                          {Color(0.0f), 0.5f, 4.0},
                          {Color(0.0f), 0.9f, 9.0},
                          {Color(0.6f), 0.5f, 15.0},
                          {Color(0.6f, 0.2f, 0.05f), 0.25f, 37.0},
                          {Color(0.6f, 0.2f, 0.05f), 0.75f, 27.0},
                          {Color(0.3f), 1.0f, 1.0}}) {
        Film film(1, 1, {0, 0, 1, 1});
        film.pixels()[0] = {c.alpha * c.color, c.alpha};
        const std::vector<std::uint8_t> rgba = shade::toDisplayWithAlpha(film);
        const Color shown = shade::toneMapNeutral(c.color);
        double squares = 0.0;
        double plain = 0.0;  // with color and alpha as light has them
        for (int n = 0; n <= 20; ++n)
            for (int k = 0; k < 3; ++k) {
                const double b = n / 20.0;
                const double light = c.alpha * shown[k] + (1.0 - c.alpha) * linear(b);
                const double wanted = 255.0 * shade::encodeSrgb(static_cast<float>(light));
                const double page = rgba[3] / 255.0 * rgba[k] + (1.0 - rgba[3] / 255.0) * 255.0 * b;
                EXPECT_NEAR(page, wanted, c.error) << c.color.r << " " << c.alpha << " over " << b << ", channel " << k;
                const double by_light = 255.0 * (c.alpha * shade::encodeSrgb(shown[k]) + (1.0 - c.alpha) * b);
                squares += (page - wanted) * (page - wanted);
                plain += (by_light - wanted) * (by_light - wanted);
            }
        if (c.alpha < 1.0f) EXPECT_LT(squares, 0.55 * plain) << c.color.r << " " << c.alpha;
    }
}

// A mask's alpha is the share of a pixel.
TEST(ToDisplayWithAlpha, KeepsTheCoverageOfAMask) {
    Film film(1, 1, {0, 0, 1, 1}, FilmContent::unit);
    film.pixels()[0] = {Color(0.5f), 0.5f};
    EXPECT_EQ(shade::toDisplayWithAlpha(film), (std::vector<std::uint8_t>{255, 255, 255, 128}));
}

TEST(ToneOptions, RefusesNonsense) {
    EXPECT_THROW((shade::ToneOptions{.exposure = 1e3}.validate()), UsageError);
    EXPECT_THROW((shade::ToneOptions{.exposure = std::numeric_limits<double>::quiet_NaN()}.validate()), UsageError);
}

}  // namespace
}  // namespace stratum
