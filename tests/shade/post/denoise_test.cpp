#include "shade/post/denoise.h"

#include "base/error.h"
#include "shade/analytic_prints.h"
#include "shade/denoise_oracle.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

namespace stratum {
namespace {

using shade::Film;

/// Its wall and, on the left, its edge and the bed: rendering the vase by its formula is what takes long here.
constexpr shade::PixelBox kPart{14, 24, 56, 50};

Film vase(int spp, std::uint32_t seed) {
    test::Vase vase;
    vase.layers = 40;
    const auto print = vase.intersector();
    shade::RenderOptions options;
    options.width = 96;
    options.height = 72;
    options.crop = kPart;
    options.spp = spp;
    options.seed = seed;
    shade::addDenoisingGuides(options);
    shade::SceneOptions scene;
    scene.camera.eye = glm::dvec3(3, -26, 8);  // layers are four pixels high
    scene.camera.look_at = glm::dvec3(0, -15, 6);
    options.margin = 0;
    return shade::render(print, shade::makeScene(scene, print, options.width, options.height), options).film;
}

double relMse(const Film& picture, const Film& reference) {
    double sum = 0.0;
    for (std::size_t n = 0; n < picture.pixels().size(); ++n)
        for (int c = 0; c < 3; ++c) {
            const double r = double(reference.pixels()[n].rgb[c]);
            const double d = double(picture.pixels()[n].rgb[c]) - r;
            sum += d * d / (r * r + 0.01);
        }
    return sum / (3.0 * double(picture.pixels().size()));
}

/// Contrast of layer lines: RMS of the second difference down the columns of the middle of the picture.
double lines(const Film& film) {
    double sum = 0.0;
    for (int y = kPart.y0 + 2; y < kPart.y1 - 2; ++y)
        for (int x = 30; x < 54; ++x) {
            const auto at = [&](int row) { return double(shade::luminance(film.at(x, row).rgb)); };
            sum += std::pow(at(y - 1) - 2.0 * at(y) + at(y + 1), 2);
        }
    return std::sqrt(sum / double((kPart.height() - 4) * 24));
}

TEST(Denoise, LessErrorAndTheSameLayerLines) {
    const Film reference = vase(128, 9);
    for (const auto& [spp, gain] : {std::pair{8, 3.0}, std::pair{16, 1.5}}) {
        Film film = vase(spp, 1);
        const Film noisy = film;
        shade::denoise(film);
        const double before = relMse(noisy, reference);
        const double after = relMse(film, reference);
        std::printf("%d spp: relMSE %.2e, denoised %.2e (%.1f times less); lines %.4f, denoised %.4f, of %.4f\n", spp,
                    before, after, before / after, lines(noisy), lines(film), lines(reference));
        EXPECT_GT(before, gain * after) << spp;
        EXPECT_NEAR(lines(film), lines(reference), 0.25 * lines(reference)) << spp;
        // The noisy picture is kept.
        const shade::FilmLayer& layer = film.layers().back();
        ASSERT_EQ(layer.name, "noisy");
        for (std::size_t n = 0; n < noisy.pixels().size(); ++n) {
            ASSERT_EQ(layer.values[3 * n + 1], noisy.pixels()[n].rgb.g);
            ASSERT_TRUE(shade::isFinite(film.pixels()[n].rgb));
        }
    }
}

TEST(Denoise, IsTheEstimatorThatItSays) {
    const Film noisy = vase(8, 1);
    const test::DenoiseOracle oracle(noisy);
    Film film = noisy;
    shade::denoise(film);
    double worst = 0.0;
    for (int y = 0; y < film.height(); y += 3)
        for (int x = 0; x < film.width(); x += 3) {
            const std::array<double, 3> expected = oracle.pixel(x, y);
            const shade::Color& c = film.at(film.region().x0 + x, film.region().y0 + y).rgb;
            for (std::size_t k = 0; k < 3; ++k)
                worst = std::max(worst, std::abs(double(c[int(k)]) - expected[k]) / (expected[k] + 0.01));
        }
    std::printf("largest difference from the plain estimator: %.1e\n", worst);
    EXPECT_LT(worst, 2e-3);
}

// A very bright sample turns the linear functions around it: pixels beside it were ten times too dark.
TEST(Denoise, OneBrightSampleDoesNotDarkenOthers) {
    const Film clean = vase(16, 1);
    Film expected = clean;
    shade::denoise(expected);
    const int width = clean.width();
    float darkest = 1;
    for (int y = 4; y < clean.height() - 4; y += 5)
        for (int x = 4; x < width - 4; x += 7) {
            Film film = clean;
            const auto at = std::size_t(y) * std::size_t(width) + std::size_t(x);
            const float bright = 40 * shade::luminance(film.pixels()[at].rgb);
            film.pixels()[at].rgb = {bright, bright, bright};
            for (shade::FilmLayer& layer : film.layers())
                if (layer.name == "variance") layer.values[at] = bright * bright;
            shade::denoise(film);
            for (std::size_t n = 0; n < film.pixels().size(); ++n)
                darkest = std::min(darkest, shade::luminance(film.pixels()[n].rgb) /
                                                (shade::luminance(expected.pixels()[n].rgb) + 1e-3f));
        }
    std::printf("at least %.2f of the light that is there without it\n", double(darkest));
    EXPECT_GT(darkest, 0.4f);
}

/// The middle of a ball of glitter, whose flakes are a few pixels large.
Film glitter(int spp, std::uint32_t seed) {
    const auto print = test::sphere({0, 0, 5}, 5.0);
    shade::RenderOptions options;
    options.width = 160;
    options.height = 120;
    options.crop = shade::PixelBox{44, 24, 116, 84};
    options.spp = spp;
    options.seed = seed;
    options.integrator.name = "direct";
    shade::addDenoisingGuides(options);
    shade::SceneOptions scene;
    scene.brdf = "glitter:0.1,0.1,0.4,0.4";
    Film film = shade::render(print, shade::makeScene(scene, print, options.width, options.height), options).film;
    return film;
}

// Flashes are no noise: without their light among the guides the brightest pixels lost a quarter.
TEST(Denoise, GlitterKeepsItsFlashes) {
    const Film reference = glitter(1024, 9);
    Film film = glitter(8, 1);
    const Film noisy = film;
    shade::denoise(film);
    std::vector<std::pair<float, std::size_t>> order;
    for (std::size_t n = 0; n < reference.pixels().size(); ++n)
        order.emplace_back(-shade::luminance(reference.pixels()[n].rgb), n);
    std::sort(order.begin(), order.end());
    order.resize(order.size() / 100);
    double sum = 0.0;
    double kept = 0.0;
    for (const auto& [light, n] : order) {
        sum -= double(light);
        kept += double(shade::luminance(film.pixels()[n].rgb));
    }
    std::printf("the brightest 1 %% keep %.3f; relMSE %.2e, denoised %.2e\n", kept / sum, relMse(noisy, reference),
                relMse(film, reference));
    EXPECT_GT(kept, 0.9 * sum);
    EXPECT_LT(relMse(film, reference), relMse(noisy, reference));
}

/// A matt ball on a bed, whole or in part.
Film ball(std::optional<shade::PixelBox> crop, double noise) {
    const auto print = test::sphere({0, 0, 1}, 1.0);
    shade::RenderOptions options;
    options.width = 150;
    options.height = 110;
    options.spp = noise > 0.0 ? 64 : 4;
    options.noise = noise;
    options.crop = crop;
    shade::addDenoisingGuides(options);
    Film film = shade::render(print, shade::makeScene({}, print, options.width, options.height), options).film;
    shade::denoise(film);
    return crop ? film.part(*crop) : film;
}

TEST(Denoise, CropIsAPartOfTheSamePicture) {
    const shade::PixelBox box{45, 37, 101, 70};
    for (const double noise : {0.0, 0.08}) {
        const Film whole = ball(std::nullopt, noise).part(box);
        const Film part = ball(box, noise);
        ASSERT_EQ(part.region(), box);
        ASSERT_EQ(whole.pixels().size(), part.pixels().size());
        EXPECT_EQ(0,
                  std::memcmp(whole.pixels().data(), part.pixels().data(), part.pixels().size() * sizeof(shade::Pixel)))
            << noise;
    }
}

TEST(Denoise, ReportsProgressUpToTheEnd) {
    Film film = vase(2, 1);
    std::uint64_t last = 0;
    shade::denoise(film, [&](std::uint64_t done, std::uint64_t total) {
        EXPECT_GT(done, last);
        EXPECT_EQ(total, film.pixels().size());
        last = done;
    });
    EXPECT_EQ(last, film.pixels().size());
}

TEST(Denoise, SameBytesForAnyNumberOfThreads) {
    Film one = vase(4, 1);
    Film many = one;
    {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
        shade::denoise(one);
    }
    shade::denoise(many);
    EXPECT_EQ(0, std::memcmp(one.pixels().data(), many.pixels().data(), one.pixels().size() * sizeof(shade::Pixel)));
}

TEST(Denoise, LeavesWhatHasNoNoise) {
    Film film = vase(4, 1);
    for (shade::FilmLayer& layer : film.layers()) std::fill(layer.values.begin(), layer.values.end(), 0.0f);
    for (shade::Pixel& p : film.pixels()) p.rgb = shade::Color(0.3f, 0.2f, 0.1f);
    shade::denoise(film);
    for (const shade::Pixel& p : film.pixels()) ASSERT_NEAR(p.rgb.g, 0.2f, 1e-5f);
}

TEST(Denoise, LeavesNoColorWhereNothingIs) {
    Film film = vase(4, 1);
    for (int y = kPart.y0; y < kPart.y1; ++y) film.at(30, y) = {};
    shade::denoise(film);
    for (int y = kPart.y0; y < kPart.y1; ++y) ASSERT_EQ(film.at(30, y).rgb, shade::Color(0.0f)) << y;
}

TEST(Denoise, RefusesWhatItCantDo) {
    Film film(8, 8, {0, 0, 8, 8});
    EXPECT_THROW(shade::denoise(film), std::invalid_argument);
    shade::RenderOptions options;
    options.integrator.name = "ao";
    EXPECT_THROW(shade::addDenoisingGuides(options), UsageError);
}

}  // namespace
}  // namespace stratum
