#include "study/picture/image_error.h"

#include "shade/film/tonemap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

namespace stratum::study {
namespace {

shade::Film filled(float value, shade::FilmContent content = shade::FilmContent::radiance, int width = 4) {
    shade::Film film(width, 3, {0, 0, width, 3}, content);
    for (shade::Pixel& p : film.pixels()) p = {shade::Color(value), 1.0f};
    return film;
}

TEST(RelativeSquaredError, IsItsFormula) {
    EXPECT_EQ(relativeSquaredError(filled(0.5f), filled(0.5f)), 0);
    EXPECT_NEAR(relativeSquaredError(filled(0.75f), filled(0.5f)), 0.0625 / 0.26, 1e-12);
    EXPECT_NEAR(relativeSquaredError(filled(0.1f), filled(0.0f)), 1, 1e-6);  // 0.01 / 0.01
    // One channel of one pixel of twelve.
    shade::Film one = filled(0.0f);
    one.pixels()[5].rgb.g = 0.2f;
    EXPECT_NEAR(relativeSquaredError(one, filled(0.0f)), 4.0 / 36, 1e-6);
    EXPECT_THROW(relativeSquaredError(filled(1), filled(1, shade::FilmContent::radiance, 5)), std::invalid_argument);
}

// Known noise on two known grey pictures is told from the difference of the greys.
TEST(SeparateNoise, FindsBoth) {
    std::mt19937 random(5);
    std::normal_distribution<float> normal;
    const auto noisy = [&](float mean, float deviation) {
        shade::Film film = filled(mean, shade::FilmContent::radiance, 8000);
        for (shade::Pixel& p : film.pixels())
            for (int c = 0; c < 3; ++c) p.rgb[c] += deviation * normal(random);
        return film;
    };
    const double scale = 1 / (0.5 * 0.5 + 0.01);
    const Separated apart =
        separateNoise(noisy(0.51f, 0.03f), noisy(0.51f, 0.03f), noisy(0.49f, 0.05f), noisy(0.49f, 0.05f));
    EXPECT_NEAR(apart.noise, 0.0009 * scale, 0.0009 * scale * 0.05);
    EXPECT_NEAR(apart.bias, 0.0004 * scale, 0.0004 * scale * 0.15);
    const Separated same =
        separateNoise(noisy(0.5f, 0.03f), noisy(0.5f, 0.03f), noisy(0.5f, 0.03f), noisy(0.5f, 0.03f));
    EXPECT_NEAR(same.bias, 0, 0.00006 * scale);
}

TEST(Displayed, IsWhatThePngHoldsButForItsDither) {
    shade::Film film(16, 4, {0, 0, 16, 4});
    for (std::size_t n = 0; n < film.pixels().size(); ++n) {
        const auto v = static_cast<float>(n) / 40.0f;
        film.pixels()[n] = {shade::Color(v, 0.5f * v, 0.1f), 1.0f};
    }
    const DisplayPicture picture = displayed(film);
    const auto bytes = shade::toDisplay(film);
    for (std::size_t n = 0; n < picture.pixels.size(); ++n)
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(picture.pixels[n][static_cast<int>(c)] * 255.0f, bytes[3 * n + c], 1.01);
    EXPECT_NEAR(displayed(filled(0.5f, shade::FilmContent::unit)).at(1, 1).r, shade::encodeSrgb(0.5f), 1e-7);
    EXPECT_NEAR(displayed(filled(1e6f)).at(0, 0).r, 1.0f, 1e-6f);
}

}  // namespace
}  // namespace stratum::study
