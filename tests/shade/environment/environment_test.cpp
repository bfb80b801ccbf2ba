#include "shade/environment/environment.h"

#include "base/error.h"
#include "refusal.h"
#include "scratch_folder.h"
#include "shade/camera/sampler.h"
#include "shade/camera/sampling.h"
#include "shade/environment/studio_and_sky.h"
#include "shade/frame.h"

#include "shade/sphere_checks.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string_view>

namespace stratum {
namespace {

using shade::Color;
using shade::EnvironmentPlacement;
using shade::makeEnvironment;

/// Integral over the sphere, midpoint rule in (z, phi).
template <typename F>
double overSphere(const F& f, int side = 1024) {
    double sum = 0.0;
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j) sum += f(shade::toSphere({(i + 0.5f) / side, (j + 0.5f) / side}));
    return sum * 4.0 * std::numbers::pi / side / side;
}

struct Case {
    const char* text;
    double azimuth;
    bool bed;
};

class Environments : public testing::TestWithParam<Case> {};

TEST(ConstantEnvironment, SampleAgreesWithRadianceAndDensity) {
    const auto env = makeEnvironment("constant:1,0.5,0.25", {});
    EXPECT_NEAR(overSphere([&](const glm::vec3& d) { return double(env->eval(d, {0, 0, 1}).pdf); }), 1.0, 2e-3);
    const double power = overSphere([&](const glm::vec3& d) { return double(shade::luminance(env->radiance(d))); });
    double estimate = 0.0;
    double squares = 0.0;
    int differ = 0;
    constexpr int kSide = 256;
    for (int i = 0; i < kSide; ++i) {
        for (int j = 0; j < kSide; ++j) {
            const auto s = env->sample(0, {(i + 0.5f) / kSide, (j + 0.5f) / kSide}, {0, 0, 1});
            ASSERT_GT(s.pdf, 0.0f);
            ASSERT_NEAR(glm::length(s.direction), 1.0f, 1e-5f);
            differ += std::abs(s.pdf - env->eval(s.direction, {0, 0, 1}).pdf) > 1e-3f * s.pdf;
            ASSERT_NEAR(shade::luminance(s.radiance), shade::luminance(env->radiance(s.direction)), 2e-3f);
            const double v = double(shade::luminance(s.radiance)) / double(s.pdf);
            estimate += v;
            squares += v * v;
        }
    }
    const double n = kSide * kSide;
    estimate /= n;
    EXPECT_NEAR(estimate, power, 2e-3 * power);
    EXPECT_LT(differ, 0.005 * n);
    // The table follows the light: the estimate's spread is small.
    EXPECT_LT(std::sqrt(squares / n - estimate * estimate), 0.25 * estimate);
}

TEST_P(Environments, SamplesItsDensity) {
    const auto env = makeEnvironment(GetParam().text, {GetParam().azimuth, GetParam().bed});
    const glm::vec3 up(0, 0, 1);
    const auto draw = [&](const glm::vec2& u) -> std::optional<glm::vec3> {
        const auto s = env->sample(0, u, up);
        if (!(s.pdf > 0.0f)) return std::nullopt;
        return s.direction;
    };
    EXPECT_LT(
        test::chiSquaredZ(
            up, std::numbers::pi, draw, [&](const glm::vec3& d) { return double(env->eval(d, up).pdf); }, 300000, 2),
        4.0);
}

TEST_P(Environments, TheBedSamplesItsDensity) {
    const auto env = makeEnvironment(GetParam().text, {GetParam().azimuth, GetParam().bed});
    const auto light = env->makeBedSampler();
    ASSERT_EQ(light->strategies(), 1);
    const auto draw = [&](const glm::vec2& u) -> std::optional<glm::vec3> {
        const auto s = light->sample(0, u, {0, 0, 1});
        if (!(s.pdf > 0.0f)) return std::nullopt;
        return s.direction;
    };
    EXPECT_LT(test::chiSquaredZ(
                  {0, 0, 1}, std::numbers::pi, draw,
                  [&](const glm::vec3& d) {
                      return double(light->eval(d, {0, 0, 1}).pdf);
                  },
                  300000, 2),
              4.0);
}

TEST_P(Environments, TheBedsDensityIsPositiveWhereLightIs) {
    const auto env = makeEnvironment(GetParam().text, {GetParam().azimuth, GetParam().bed});
    const auto light = env->makeBedSampler();
    overSphere(
        [&](const glm::vec3& d) {
            if (d.z > 0.0f && shade::maxComponent(env->radiance(d)) > 0.0f) {
                EXPECT_GT(light->eval(d, {0, 0, 1}).pdf, 0.0f);
            }
            return 0.0;
        },
        256);
}

/// With one sample by the light and one by a matt surface, as PathIntegrator joins them.
TEST_P(Environments, LightsAMattSurfaceTogetherWithItsCosine) {
    const auto env = makeEnvironment(GetParam().text, {GetParam().azimuth, GetParam().bed});
    for (const glm::vec3 normal : {glm::vec3(0, 0, 1), glm::normalize(glm::vec3(-2, 1, 0.3f)), glm::vec3(0, -1, 0)}) {
        const shade::Frame frame(normal);
        const auto cosine = [&](const glm::vec3& d) { return std::max(0.0f, glm::dot(d, normal)); };
        const double expected =
            overSphere([&](const glm::vec3& d) { return double(shade::luminance(env->radiance(d)) * cosine(d)); });
        double estimate = 0.0;
        double squares = 0.0;
        constexpr int kSide = 512;
        for (int i = 0; i < kSide; ++i) {
            for (int j = 0; j < kSide; ++j) {
                const glm::vec2 u((i + 0.5f) / kSide, (j + 0.5f) / kSide);
                float v = 0.0f;
                if (const auto s = env->sample(0, u, normal); s.pdf > 0.0f) {
                    const float c = cosine(s.direction);
                    v += shade::luminance(s.radiance) * c / (s.pdf + c * shade::kInvPi);
                }
                const glm::vec3 way = frame.toWorld(shade::toCosineHemisphere(u));
                const auto there = env->eval(way, normal);
                if (const float c = cosine(way); c > 0.0f)
                    v += shade::luminance(there.radiance) * c / (there.pdf + c * shade::kInvPi);
                estimate += double(v);
                squares += double(v * v);
            }
        }
        const double n = double(kSide) * kSide;
        estimate /= n;
        EXPECT_NEAR(estimate, expected, 3e-3 * expected);
        EXPECT_LT(std::sqrt(squares / n - estimate * estimate), 0.6 * estimate);
    }
}

INSTANTIATE_TEST_SUITE_P(All, Environments,
                         testing::Values(Case{"constant:1,0.5,0.25", 0.0, false}, Case{"studio", 0.0, true},
                                         Case{"studio", 2.1, true}, Case{"studio", -1.0, false}));

TEST(Studio, LightsAWhiteSheetToItsLevel) {
    const auto env = makeEnvironment("studio", {0.7, true});
    EXPECT_NEAR(shade::luminance(env->irradianceFromAbove()) * shade::kInvPi, shade::kStudioLevel, 5e-3f);
    EXPECT_FALSE(env->visible());
}

TEST(Studio, TurnsWithTheCamera) {
    const auto a = makeEnvironment("studio", {0.0, true});
    const auto b = makeEnvironment("studio", {0.5 * std::numbers::pi, true});
    for (int i = 0; i < 100; ++i) {
        const glm::vec3 d = shade::toSphere({(i % 10 + 0.5f) / 10, (i / 10 + 0.5f) / 10});
        EXPECT_NEAR(a->radiance(d).r, b->radiance({-d.y, d.x, d.z}).r, 1e-3f);
    }
}

TEST(Studio, HasNoLightBelowABed) {
    const auto env = makeEnvironment("studio", {0.0, true});
    EXPECT_EQ(env->radiance({0.0f, 0.6f, -0.8f}), Color(0.0f));
    EXPECT_GT(makeEnvironment("studio", {0.0, false})->radiance({0.0f, 0.6f, -0.8f}).r, 0.0f);
}

TEST(BedSampler, OpenBedIsNearlyFreeOfNoise) {
    for (const char* text : {"constant:1,1,1", "studio"}) {
        const auto env = makeEnvironment(text, {0.3, true});
        const auto light = env->makeBedSampler();
        const double expected = double(shade::luminance(env->irradianceFromAbove()));
        double sum = 0.0;
        double squares = 0.0;
        constexpr std::uint32_t kSamples = 1u << 16;
        shade::Sampler sampler(1, kSamples);
        for (std::uint32_t i = 0; i < kSamples; ++i) {
            sampler.start(0, 0, i);
            const auto s = light->sample(0, sampler.next2D(), {0, 0, 1});
            if (!(s.pdf > 0.0f)) continue;  // beyond a pole, rarely
            const double v =
                double(shade::luminance(s.radiance)) * double(std::max(s.direction.z, 0.0f)) / double(s.pdf);
            sum += v;
            squares += v * v;
        }
        const double mean = sum / kSamples;
        EXPECT_NEAR(mean, expected, 2e-3 * expected) << text;
        EXPECT_LT(std::sqrt(squares / kSamples - mean * mean), 0.12 * mean) << text;
    }
}

TEST(MakeEnvironment, RefusesNonsense) {
    for (const char* text : {"", "skies", "sky:1", "sky:0,0", "sky:45,0,99", "no_such.hdr", "studio:1", "constant",
                             "constant:1,2", "constant:-1,0,0", "constant:1,1,x"})
        EXPECT_THROW(makeEnvironment(text, {}), UsageError) << text;
}

TEST(MakeEnvironment, PresetsComeBeforeFilesOfTheirNames) {
    const test::ScratchFolder folder;
    const test::WorkingFolder inside(folder.path());
    std::filesystem::create_directory("studio");
    std::ofstream("sky") << "no map";
    std::ofstream("constant:1,1,1") << "no map";
    EXPECT_NO_THROW(makeEnvironment("studio", {}));
    EXPECT_NO_THROW(makeEnvironment("sky", {}));
    EXPECT_NO_THROW(makeEnvironment("constant:1,1,1", {}));
    EXPECT_THROW(makeEnvironment("./sky", {}), InputError);
}

TEST(MakeEnvironment, GuessesMistypedPresets) {
    EXPECT_TRUE(test::refuses<UsageError>("did you mean 'studio'?", [&] { makeEnvironment("studoi", {}); }));
}

}  // namespace
}  // namespace stratum
