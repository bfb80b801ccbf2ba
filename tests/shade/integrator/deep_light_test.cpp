#include "shade/integrator/deep_light.h"

#include "shade/analytic_prints.h"
#include "shade/mean_radiance.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>

namespace stratum {
namespace {

using shade::Color;
using shade::RenderOptions;
using shade::RenderResult;

RenderOptions smallOptions(int spp) {
    RenderOptions options;
    options.width = 32;
    options.height = 24;
    options.spp = spp;
    return options;
}

/// Four shells, one in the other, as walls and infill are: paths meet many surfaces.
test::FunctionIntersector shells() {
    constexpr std::array<double, 8> kRadii{3.0, 2.8, 2.3, 2.1, 1.6, 1.4, 0.9, 0.7};
    return {{{-3.0, -3.0, 0.0}, {3.0, 3.0, 6.0}}, 1e-7, [kRadii](const trace::Ray& ray, trace::Hit& hit) {
                const glm::dvec3 m = ray.origin - glm::dvec3(0.0, 0.0, 3.0);
                const double b = glm::dot(m, ray.direction);
                bool found = false;
                for (std::size_t n = 0; n < kRadii.size(); ++n) {
                    const double root = b * b - glm::dot(m, m) + kRadii[n] * kRadii[n];
                    if (root < 0.0) continue;
                    for (const double t : {-b - std::sqrt(root), -b + std::sqrt(root)}) {
                        if (t < ray.t_min || t > ray.t_max || (found && t >= hit.t)) continue;
                        found = true;
                        hit.t = t;
                        hit.position = ray.origin + t * ray.direction;
                        const glm::dvec3 out = glm::normalize(m + t * ray.direction);
                        hit.normal = n % 2 == 0 ? out : -out;
                    }
                }
                return found;
            }};
}
const test::FunctionIntersector kShells = shells();

/// Mean and mean square error against `exact` of the pixels on the print.
struct Difference {
    glm::dvec3 mean{0.0}, exact{0.0};
    double square = 0.0;
};

Difference difference(const shade::Film& film, const shade::Film& exact) {
    Difference d;
    const double n = static_cast<double>(film.pixels().size());
    for (std::size_t i = 0; i < film.pixels().size(); ++i) {
        const glm::dvec3 a(film.pixels()[i].rgb);
        const glm::dvec3 b(exact.pixels()[i].rgb);
        d.mean += a / n;
        d.exact += b / n;
        d.square += glm::dot(a - b, a - b) / n;
    }
    return d;
}

TEST(DeepLight, IsMadeWhereAPictureUsesIt) {
    const auto translucent = test::plainScene(kShells, "translucent:0.9,0.8,0.6,0.8", "sky", true);
    EXPECT_NE(shade::makeRadianceCache(translucent, kShells, smallOptions(4)), nullptr);
    const auto opaque = test::plainScene(kShells, "lambert:0.5,0.5,0.5", "sky", true);
    EXPECT_EQ(shade::makeRadianceCache(opaque, kShells, smallOptions(4)), nullptr);
    RenderOptions exact = smallOptions(4);
    exact.integrator.exact_translucency = true;
    EXPECT_EQ(shade::makeRadianceCache(translucent, kShells, exact), nullptr);
    RenderOptions normal = smallOptions(4);
    normal.integrator.name = "normal";
    EXPECT_EQ(shade::makeRadianceCache(translucent, kShells, normal), nullptr);
}

TEST(DeepLight, FollowsASixteenthOfTheSamples) {
    const auto scene = test::plainScene(kShells, "translucent:0.9,0.8,0.6,0.8", "sky", true);
    EXPECT_EQ(shade::makeRadianceCache(scene, kShells, smallOptions(4))->paths(), 1024u);
    EXPECT_EQ(shade::makeRadianceCache(scene, kShells, smallOptions(64))->paths(), 3072u);
    RenderOptions to_an_error = smallOptions(4096);
    to_an_error.noise = 0.1;
    EXPECT_EQ(shade::makeRadianceCache(scene, kShells, to_an_error)->paths(), 1024u);
}

// Paths in a lossless solid under a light that is 1 everywhere bring 1, wherever they are.
TEST(DeepLight, IsOneInAWhiteFurnace) {
    const auto scene = test::plainScene(kShells, "translucent:1,1,1,1.5", "constant:1,1,1", false);
    const auto cache = shade::makeRadianceCache(scene, kShells, smallOptions(256));
    EXPECT_GT(cache->known(), 200u);
    RenderOptions options = smallOptions(64);
    options.integrator.radiance_cache = cache;
    const RenderResult result = shade::render(kShells, scene, options);
    EXPECT_EQ(result.radiance_cache, cache);
    for (const shade::Pixel& pixel : result.film.pixels()) EXPECT_NEAR(pixel.rgb.r, 1.0f, 0.2f);
    Color mean(0.0f);
    for (const shade::Pixel& pixel : result.film.pixels()) mean += pixel.rgb;
    EXPECT_NEAR(mean.r / static_cast<float>(result.film.pixels().size()), 1.0f, 0.003f);
}

TEST(DeepLight, PicturesAreThoseOfPathsToTheirEnds) {
    for (const char* brdf : {"clear-petg", "natural-pla", "lithophane-white"}) {
        const auto scene = test::plainScene(kShells, brdf, "studio", true);
        RenderOptions exact = smallOptions(1024);
        exact.integrator.exact_translucency = true;
        exact.seed = 5;
        const shade::Film truth = shade::render(kShells, scene, exact).film;
        exact.spp = 64;
        exact.seed = 1;
        RenderOptions cached = smallOptions(64);
        cached.integrator.radiance_cache = shade::makeRadianceCache(scene, kShells, smallOptions(1024));
        const RenderResult followed = shade::render(kShells, scene, exact);
        const RenderResult ended = shade::render(kShells, scene, cached);
        EXPECT_EQ(followed.radiance_cache, nullptr);
        const Difference before = difference(followed.film, truth);
        const Difference now = difference(ended.film, truth);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(now.mean[c], now.exact[c], 0.01 * now.exact[c]) << brdf;
        EXPECT_LT(now.square, before.square) << brdf;
        EXPECT_LT(ended.rays.total(), followed.rays.total()) << brdf;
    }
}

TEST(DeepLight, PartsAndThreadsGiveTheSameBytes) {
    const auto scene = test::plainScene(kShells, "natural-pla", "sky", true);
    const shade::Film whole = shade::render(kShells, scene, smallOptions(8)).film;
    RenderOptions part = smallOptions(8);
    part.crop = shade::PixelBox{8, 6, 20, 18};
    const shade::Film cropped = shade::render(kShells, scene, part).film;
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const shade::Film alone = shade::render(kShells, scene, smallOptions(8)).film;
    for (int y = 0; y < 24; ++y) {
        for (int x = 0; x < 32; ++x) {
            EXPECT_EQ(whole.pixels()[whole.index(x, y)].rgb, alone.pixels()[alone.index(x, y)].rgb);
            if (x >= 8 && x < 20 && y >= 6 && y < 18)
                EXPECT_EQ(whole.pixels()[whole.index(x, y)].rgb, cropped.pixels()[cropped.index(x, y)].rgb);
        }
    }
}

TEST(DeepLight, EndsWhereItIsToldTo) {
    const auto scene = test::plainScene(kShells, "natural-pla", "sky", true);
    EXPECT_THROW(shade::makeRadianceCache(scene, kShells, smallOptions(64), [] { throw std::runtime_error("enough"); }),
                 std::runtime_error);
}

// A page that moves puts the work off: what is done stays, and the picture is the same in the end.
TEST(DeepLight, GoesOnWhereItWasPutOff) {
    const auto scene = test::plainScene(kShells, "natural-pla", "sky", true);
    RenderOptions options = smallOptions(64);
    const shade::Film whole = shade::render(kShells, scene, options).film;
    options.integrator.cache_work = std::make_shared<shade::RadianceCacheWork>();
    int stops = 0;
    for (bool done = false; !done;) {
        int calls = 0;
        try {
            (void)shade::makeRadianceCache(scene, kShells, options, [&calls] {
                if (++calls > 2) throw std::runtime_error("another page moves");
            });
            done = true;
        } catch (const std::runtime_error&) {
            ASSERT_LT(++stops, 100);
        }
    }
    EXPECT_GT(stops, 0);
    const shade::Film again = shade::render(kShells, scene, options).film;
    for (std::size_t n = 0; n < whole.pixels().size(); ++n) EXPECT_EQ(whole.pixels()[n].rgb, again.pixels()[n].rgb);
}

// A camera that sees no print at all must not look for it for ever.
TEST(DeepLight, ACameraThatLooksAwayLearnsNothing) {
    auto scene = test::plainScene(kShells, "natural-pla", "sky", true);
    scene.camera = shade::Camera({50.0, 0.0, 60.0}, {100.0, 0.0, 120.0}, {0.0, 0.0, 1.0}, 30.0, 32, 24);
    const auto cache = shade::makeRadianceCache(scene, kShells, smallOptions(4));
    EXPECT_EQ(cache->paths(), 0u);
    EXPECT_EQ(cache->known(), 0u);
}

}  // namespace
}  // namespace stratum
