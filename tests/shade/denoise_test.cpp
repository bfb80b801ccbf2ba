#include "shade/denoise.h"

#include "io/error.h"
#include "shade/analytic_prints.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>

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

TEST(Denoise, RefusesWhatItCantDo) {
    Film film(8, 8, {0, 0, 8, 8});
    EXPECT_THROW(shade::denoise(film), std::invalid_argument);
    shade::RenderOptions options;
    options.integrator.name = "ao";
    EXPECT_THROW(shade::addDenoisingGuides(options), UsageError);
}

}  // namespace
}  // namespace stratum
