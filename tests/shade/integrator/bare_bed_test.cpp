// What of the bed's light the print keeps, against form factors: in transparent pictures, and as a control variate in
// opaque ones.
#include "shade/scene/scene.h"

#include "shade/analytic_prints.h"
#include "shade/environment/studio_and_sky.h"
#include "shade/integrator/path.h"
#include "shade/integrator/render.h"
#include "shade/mean_radiance.h"
#include "shade/post/denoise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace stratum {
namespace {

using shade::Color;

constexpr int kColumns = 48;
constexpr int kRows = 36;

shade::SceneDescription transparentScene(const trace::Intersector& print, const char* brdf, const char* env,
                                         bool bed = true) {
    shade::SceneOptions options;
    options.brdf = brdf;
    options.env = env;
    options.bed = bed;
    options.bed_height = 0.0;
    options.transparent = true;
    return shade::makeScene(options, print, kColumns, kRows);
}

shade::RenderOptions pictureOf(int samples) {
    shade::RenderOptions options;
    options.width = kColumns;
    options.height = kRows;
    options.spp = samples;
    return options;
}

/// Calls visit(pixel) for samples of one ray that sees a place on the bed.
template <typename Visit>
void forEachSample(const trace::Intersector& print, const shade::SceneDescription& scene, const glm::dvec3& place,
                   std::uint32_t samples, const Visit& visit) {
    const shade::PathIntegrator integrator(scene, print, 3);
    const auto tracer = print.makeTracer();
    shade::Sampler sampler(1, samples);
    shade::RayCounts rays;
    shade::TraceContext context{*tracer, sampler, rays};
    trace::Ray ray;
    ray.origin = place + glm::dvec3(9, -9, 4);
    ray.direction = glm::normalize(place - ray.origin);
    for (std::uint32_t s = 0; s < samples; ++s) {
        sampler.start(3, 4, s);
        visit(test::radianceOf(integrator, ray, context));
    }
}

float meanAlpha(const trace::Intersector& print, const shade::SceneDescription& scene, const glm::dvec3& place,
                std::uint32_t samples = 8192) {
    double sum = 0.0;
    forEachSample(print, scene, place, samples, [&](const shade::Pixel& pixel) {
        EXPECT_EQ(pixel.rgb, Color(0.0f));
        sum += double(pixel.alpha);
    });
    return static_cast<float>(sum / samples);
}

TEST(ShadowCatcher, ABlackBallTakesItsFormFactor) {
    // Of a sphere wholly above a horizontal patch: R^2 h / r^3.
    constexpr double kRadius = 1.0, kHeight = 2.5;
    const auto ball = test::sphere({0, 0, kHeight}, kRadius);
    const auto scene = transparentScene(ball, "lambert:0,0,0", "constant:1,1,1");
    for (const double x : {0.0, 1.0, 3.0, 10.0}) {
        const double r = std::hypot(x, kHeight);
        EXPECT_NEAR(meanAlpha(ball, scene, {x, 0, 0}), kRadius * kRadius * kHeight / (r * r * r), 0.006) << x;
    }
}

TEST(ShadowCatcher, AlphaIsExactlyZeroWithoutAShadowAndOneInAFullOne) {
    const auto ball = test::sphere({0, 0, 3}, 1.0);
    auto scene = transparentScene(ball, "lambert:0,0,0", "constant:0,0,0");
    const auto none = test::nothing();
    for (const char* env : {"studio", "sky", "constant:1,2,3"}) {
        const auto empty = transparentScene(none, "lambert:1,1,1", env);
        EXPECT_EQ(meanAlpha(none, empty, {1, 2, 0}, 64), 0.0f) << env;
    }
    scene.lights.push_back(shade::parseLight("directional:0,0,-1,1,1,1"));
    EXPECT_EQ(meanAlpha(ball, scene, {1.1, 0, 0}, 16), 0.0f);
    EXPECT_NEAR(meanAlpha(ball, scene, {0.9, 0, 0}, 16), 1.0f, 1e-5f);
}

TEST(ShadowCatcher, OverTheBareBedThePictureIsTheOpaqueOne) {
    const auto ball = test::sphere({0, 0, 1.2}, 1.0);
    const shade::RenderOptions options = pictureOf(256);
    auto opaque = transparentScene(ball, "lambert:0.7,0.3,0.1", "studio");
    const auto transparent = opaque;
    opaque.transparent = false;
    opaque.catcher.reset();
    ASSERT_TRUE(transparent.catcher);
    const shade::Film a = shade::render(ball, opaque, options).film;
    shade::Film b = shade::render(ball, transparent, options).film;
    EXPECT_FALSE(a.transparent());
    ASSERT_TRUE(b.transparent());
    EXPECT_FLOAT_EQ(b.bareBed(), transparent.catcher->bare);
    double difference = 0.0;
    double light = 0.0;
    double shadow = 0.0;
    for (std::size_t n = 0; n < a.pixels().size(); ++n) {
        const shade::Pixel& p = b.pixels()[n];
        EXPECT_GE(p.alpha, 0.0f);
        EXPECT_LE(p.alpha, 1.0f);
        if (!(a.pixels()[n].alpha > 0.99f)) continue;  // above the horizon
        const double over = double(shade::luminance(p.rgb) + (1.0f - p.alpha) * b.bareBed());
        difference += std::abs(over - double(shade::luminance(a.pixels()[n].rgb)));
        light += double(shade::luminance(a.pixels()[n].rgb));
        if (p.rgb == Color(0.0f)) shadow = std::max(shadow, double(p.alpha));
    }
    EXPECT_LT(difference, 0.01 * light);
    EXPECT_GT(shadow, 0.3);
}

/// Mean and standard deviation of the luminance of single samples at a place on the bed.
std::array<double, 2> onTheBed(const trace::Intersector& print, const shade::SceneDescription& scene,
                               const glm::dvec3& place) {
    constexpr std::uint32_t kSamples = 16384;
    double sum = 0.0;
    double squares = 0.0;
    forEachSample(print, scene, place, kSamples, [&](const shade::Pixel& pixel) {
        const double value = double(shade::luminance(pixel.rgb));
        sum += value;
        squares += value * value;
    });
    const double mean = sum / kSamples;
    return {mean, std::sqrt(std::max(squares / kSamples - mean * mean, 0.0))};
}

// In the contact shadow of a black ball nearly nothing is left of the bed's known light.
TEST(BareBed, NoPixelIsBelowZero) {
    const auto ball = test::sphere({0, 0, 1.001}, 1.0);
    auto scene = transparentScene(ball, "lambert:0,0,0", "studio");
    scene.transparent = false;
    scene.catcher.reset();
    const shade::RenderOptions options = pictureOf(2);
    std::size_t dark = 0;
    const shade::Film film = shade::render(ball, scene, options).film;
    for (const shade::Pixel& pixel : film.pixels()) {
        EXPECT_GE(std::min({pixel.rgb.r, pixel.rgb.g, pixel.rgb.b}), 0.0f);
        dark += shade::luminance(pixel.rgb) == 0.0f;
    }
    EXPECT_GT(dark, 20U);
}

TEST(BareBed, ABlackBallTakesItsFormFactorAndABareBedHasNoNoise) {
    constexpr double kRadius = 1.0, kHeight = 2.5;
    const auto ball = test::sphere({0, 0, kHeight}, kRadius);
    auto scene = transparentScene(ball, "lambert:0,0,0", "constant:1,1,1");
    scene.transparent = false;
    scene.catcher.reset();
    scene.bed->fade_begin = 1e6;
    scene.bed->fade_end = 2e6;
    const double white = double(shade::luminance(scene.bed->texture.mean()));
    for (const double x : {0.0, 1.0, 3.0, 10.0}) {
        const double r = std::hypot(x, kHeight);
        const auto [mean, noise] = onTheBed(ball, scene, {x, 0, 0});
        EXPECT_NEAR(mean / white, 1.0 - kRadius * kRadius * kHeight / (r * r * r), 0.004) << x;
    }
    scene.environment = shade::makeEnvironment("studio", {});
    const auto near = onTheBed(ball, scene, {1.5, 0, 0});
    const auto far = onTheBed(ball, scene, {400, 0, 0});
    EXPECT_LT(far[1], 1e-3 * far[0]);
    EXPECT_GT(near[1], 30 * far[1]);
    EXPECT_NEAR(far[0] / white, double(shade::kStudioLevel), 0.005);
    // As far as it is bare, sampled light is the same to what float sums allow, lamps or not.
    scene.lights.push_back(shade::parseLight("directional:0,0,-1,0,0,0"));  // no control variate beside lamps
    const auto sampled = onTheBed(ball, scene, {400, 0, 0});
    EXPECT_GT(sampled[1], 20 * far[1]);
    EXPECT_NEAR(sampled[0], far[0], 4 * sampled[1] / std::sqrt(16384.0));
    const auto sampled_near = onTheBed(ball, scene, {1.5, 0, 0});
    EXPECT_NEAR(sampled_near[0], near[0], 4 * (sampled_near[1] + near[1]) / std::sqrt(16384.0));
    EXPECT_LT(near[1], sampled_near[1]);
}

TEST(ShadowCatcher, DenoisingSmoothsTheShadowAndKeepsThePrint) {
    const auto ball = test::sphere({0, 0, 1.2}, 1.0);
    const auto scene = transparentScene(ball, "lambert:0.7,0.3,0.1", "constant:1,1,1");
    shade::RenderOptions options = pictureOf(1024);
    const shade::Film reference = shade::render(ball, scene, options).film;
    options.spp = 8;
    shade::addDenoisingGuides(options);
    const shade::Film noisy = shade::render(ball, scene, options).film;
    shade::Film clean = noisy;
    shade::denoise(clean);
    const auto error = [&](const shade::Film& film) {
        double sum = 0.0;
        for (std::size_t n = 0; n < film.pixels().size(); ++n)
            sum += std::pow(double(film.pixels()[n].alpha - reference.pixels()[n].alpha), 2);
        return sum;
    };
    EXPECT_LT(error(clean), 0.5 * error(noisy));
    for (std::size_t n = 0; n < clean.pixels().size(); ++n) {
        EXPECT_GE(clean.pixels()[n].alpha, 0.0f);
        EXPECT_LE(clean.pixels()[n].alpha, 1.0f);
        const bool print = reference.pixels()[n].alpha == 1.0f && shade::luminance(reference.pixels()[n].rgb) > 0.0f;
        if (print) {
            EXPECT_NEAR(clean.pixels()[n].alpha, 1.0f, 0.02f);
        }
    }
}

TEST(ShadowCatcher, WithoutABedOrBehindAMapNothingIsBehindThePrint) {
    const auto ball = test::sphere({0, 0, 1.2}, 1.0);
    const shade::RenderOptions options = pictureOf(4);
    for (const char* env : {"studio", "sky"}) {
        const auto scene = transparentScene(ball, "lambert:0.7,0.3,0.1", env, false);
        EXPECT_FALSE(scene.catcher);
        EXPECT_FALSE(scene.backdrop);
        const shade::Film film = shade::render(ball, scene, options).film;
        EXPECT_TRUE(film.transparent());
        EXPECT_EQ(film.bareBed(), 0.0f);
        EXPECT_EQ(film.at(0, 0).alpha, 0.0f);
        EXPECT_EQ(film.at(0, 0).rgb, Color(0.0f));
        EXPECT_EQ(film.at(24, 18).alpha, 1.0f);
    }
}

}  // namespace
}  // namespace stratum
