#include "shade/map_environment.h"

#include "corpus.h"
#include "shade/analytic_prints.h"
#include "shade/bed_light.h"
#include "shade/frame.h"
#include "shade/path.h"
#include "shade/sampling.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace stratum {
namespace {

using shade::Color;
using shade::LightMap;
using shade::MapEnvironment;

constexpr double kPi = std::numbers::pi;

/// A dim gradient with one texel that outshines all others 10^5 times.
LightMap sunny(int height = 32) {
    LightMap map{2 * height, height, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < map.width; ++x)
            map.texels.emplace_back(0.5f + 0.3f * std::sin(0.1f * float(x)), 0.6f,
                                    0.2f + 0.5f * float(y) / float(height));
    map.texels[std::size_t(height / 4 * map.width + height / 3)] = Color(9e4f, 8e4f, 6e4f);
    return map;
}

template <typename F>
double overMap(int height, const F& f) {
    double sum = 0.0;
    for (int j = 0; j < height; ++j) {
        const double theta = kPi * (j + 0.5) / height;
        for (int i = 0; i < 2 * height; ++i) {
            const double phi = kPi * (i + 0.5) / height;
            sum += std::sin(theta) *
                   f(glm::vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)));
        }
    }
    return sum * kPi / height * kPi / height;
}

TEST(MapEnvironment, LooksLikeInBlender) {
    // Middle column towards +x, a quarter to its left +y; rotation turns it counter-clockwise.
    LightMap map{64, 32, std::vector<Color>(2048, Color(0.1f))};
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x) map.texels[std::size_t(y * 64 + x)] = Color(float(x), float(y), 1.0f);
    const MapEnvironment env(map, 0.0, 1.0f);
    EXPECT_NEAR(env.radiance({1, 0, 0}).r, 31.5f, 1e-3f);
    EXPECT_NEAR(env.radiance({0, 1, 0}).r, 15.5f, 1e-3f);
    EXPECT_NEAR(env.radiance({0, -1, 0}).r, 47.5f, 1e-3f);
    EXPECT_NEAR(env.radiance({1, 0, 0}).g, 15.5f, 1e-3f);
    EXPECT_NEAR(env.radiance({0, 0, 1}).g, 0.0f, 1e-3f);
    EXPECT_NEAR(env.radiance({0, 0, -1}).g, 31.0f, 1e-3f);
    const MapEnvironment turned(map, 0.5 * kPi, 2.0f);
    EXPECT_NEAR(turned.radiance({0, 1, 0}).r, 2.0f * 31.5f, 1e-2f);
}

TEST(MapEnvironment, DensityIsThatOfTheSamples) {
    for (const double rotation : {0.0, 2.0}) {
        const MapEnvironment env(sunny(), rotation, 1.0f);
        EXPECT_NEAR(overMap(2048, [&](const glm::vec3& d) { return double(env.pdf(d)); }), 2.0, 4e-3);
        ASSERT_EQ(env.strategies(), 2);  // the sun has its own
        constexpr int kZ = 16;
        constexpr int kPhi = 32;
        std::vector<double> expected(kZ * kPhi, 0.0);
        const auto cell = [&](const glm::vec3& d) {
            const double phi = std::atan2(double(d.y), double(d.x)) + kPi;
            return std::size_t(std::min(kZ - 1, int((double(d.z) + 1.0) * 0.5 * kZ)) * kPhi +
                               std::min(kPhi - 1, int(phi / (2.0 * kPi) * kPhi)));
        };
        constexpr int kHeight = 2048;
        overMap(kHeight, [&](const glm::vec3& d) {
            const double s = std::hypot(double(d.x), double(d.y));
            expected[cell(d)] += double(env.pdf(d)) * s * kPi / kHeight * kPi / kHeight;
            return 0.0;
        });
        constexpr int kDraws = 300000;
        std::vector<double> seen(expected.size(), 0.0);
        int differ = 0;
        std::mt19937 random(4);
        std::uniform_real_distribution<float> uniform(0.0f, 0x1.fffffep-1f);
        for (int n = 0; n < 2 * kDraws; ++n) {
            const float x = uniform(random);
            const auto s = env.sample(n % 2, {x, uniform(random)});
            if (!(s.pdf > 0.0f)) continue;
            // A direction in floats may fall into the next row, whose mean sine is another.
            differ += std::abs(env.pdf(s.direction) - s.pdf) > 0.01f * s.pdf;
            seen[cell(s.direction)] += 1.0;
        }
        EXPECT_LT(differ, 30);
        double chi2 = 0.0;
        int degrees = -1;
        for (std::size_t c = 0; c < seen.size(); ++c) {
            const double e = expected[c] * kDraws;
            if (e < 20.0) continue;
            chi2 += (seen[c] - e) * (seen[c] - e) / e;
            ++degrees;
        }
        EXPECT_LT((chi2 - degrees) / std::sqrt(2.0 * std::max(degrees, 1)), 4.0);
    }
}

TEST(MapEnvironment, SamplesOfTheSunHaveOneValue) {
    // Radiance over density is the same all over the bright texel and its edges: no noise of its own.
    const MapEnvironment env(sunny(64), 0.0, 1.0f);
    double least = 1e30;
    double most = 0.0;
    for (int i = 0; i < 64; ++i) {
        for (int j = 0; j < 64; ++j) {
            const auto s = env.sample(1, {(i + 0.5f) / 64, (j + 0.5f) / 64});
            if (shade::luminance(s.radiance) < 1000.0f) continue;
            least = std::min(least, double(shade::luminance(s.radiance) / s.pdf));
            most = std::max(most, double(shade::luminance(s.radiance) / s.pdf));
        }
    }
    EXPECT_LT(most / least, 1.1);
}

TEST(MapEnvironment, BedLightAloneIsComplete) {
    const MapEnvironment env(sunny(), 1.0, 1.0f);
    const auto light = env.makeBedLight();
    const double expected = overMap(2048, [&](const glm::vec3& d) {
        return double(std::max(d.z, 0.0f)) * double(shade::luminance(env.radiance(d)));
    });
    double sum = 0.0;
    double squares = 0.0;
    constexpr int kSide = 256;
    ASSERT_EQ(light->strategies(), 2);
    for (int i = 0; i < kSide; ++i) {
        for (int j = 0; j < kSide; ++j) {
            double v = 0.0;
            for (int strategy = 0; strategy < 2; ++strategy) {
                const auto s = light->sample(strategy, {(i + 0.5f) / kSide, (j + 0.5f) / kSide});
                if (s.pdf > 0.0f)
                    v += double(shade::luminance(s.radiance)) * double(std::max(s.direction.z, 0.0f)) / double(s.pdf);
            }
            sum += v;
            squares += v * v;
        }
    }
    const double mean = sum / kSide / kSide;
    EXPECT_NEAR(mean, expected, 5e-3 * expected);
    EXPECT_LT(std::sqrt(squares / kSide / kSide - mean * mean), 0.2 * mean);
}

/// Direct light of a ball, seen at many points, against the sum over all texels; errors relative to the mean.
std::vector<double> errorsAt(const MapEnvironment& env, const char* brdf, std::uint32_t spp, int height) {
    const auto ball = test::sphere({0, 0, 0}, 1.0);
    shade::SceneOptions options;
    options.brdf = brdf;
    options.env = "constant:0,0,0";
    options.bed = false;
    auto scene = shade::makeScene(options, ball, 32, 24);
    scene.environment = std::make_shared<MapEnvironment>(env);
    const shade::PathIntegrator path(scene, ball, 1);
    const auto tracer = ball.makeTracer();
    shade::RayCounts rays;
    shade::Sampler sampler(7, spp);
    shade::TraceContext context{*tracer, sampler, rays};
    std::vector<double> errors;
    double mean = 0.0;
    constexpr int kPoints = 12;
    for (int p = 0; p < kPoints; ++p) {
        const double a = 2.4 * p;
        const double z = -0.8 + 1.6 * (p + 0.5) / kPoints;
        const glm::dvec3 n(std::sqrt(1 - z * z) * std::cos(a), std::sqrt(1 - z * z) * std::sin(a), z);
        const glm::dvec3 tangent = glm::normalize(glm::cross(n, glm::dvec3(0.3, 0.5, 0.8)));
        march::Ray ray;
        ray.origin = 3.0 * glm::normalize(n + 0.8 * tangent) + n * 0.2;
        ray.direction = glm::normalize(n - ray.origin);
        const shade::Frame frame{glm::vec3(n)};
        const glm::vec3 wo = frame.toLocal(glm::vec3(-ray.direction));
        const double expected = overMap(height, [&](const glm::vec3& d) {
            const glm::vec3 wi = frame.toLocal(d);
            if (!(wi.z > 0.0f)) return 0.0;
            return double(shade::luminance(scene.material->eval(wo, wi) * wi.z * env.radiance(d)));
        });
        mean += expected / kPoints;
        for (int trial = 0; trial < 40; ++trial) {
            double sum = 0.0;
            for (std::uint32_t s = 0; s < spp; ++s) {
                sampler.start(64 * trial, 64 * p, s);
                sum += double(shade::luminance(path.radiance(ray, context).rgb));
            }
            errors.push_back(std::abs(sum / spp - expected));
        }
    }
    for (double& e : errors) e /= mean;
    std::sort(errors.begin(), errors.end());
    return errors;
}

double rms(const std::vector<double>& errors) {
    double sum = 0.0;
    for (const double e : errors) sum += e * e;
    return std::sqrt(sum / double(errors.size()));
}

TEST(MapEnvironment, SunConvergesWithoutFireflies) {
    STRATUM_NEEDS_CORPUS(file, "env/golden_gate_hills_1k.hdr");
    const MapEnvironment env(shade::readLightMap(file), 0.0, 1.0f);
    for (const auto& [brdf, steepest] : {std::pair{"lambert:0.5,0.5,0.5", -0.6}, {"plastic:0.5,0.5,0.5,0.2", -0.55}}) {
        const auto few = errorsAt(env, brdf, 16, 1024);
        const auto more = errorsAt(env, brdf, 64, 1024);
        const auto many = errorsAt(env, brdf, 1024, 1024);
        const double slope = std::log(rms(many) / rms(few)) / std::log(64.0);
        std::printf("%s: rms %.4f at 16, %.4f at 64 (largest %.4f), %.4f at 1024 samples; slope %.2f\n", brdf, rms(few),
                    rms(more), more.back(), rms(many), slope);
        EXPECT_LT(slope, steepest) << brdf;
        EXPECT_LT(more.back(), 0.1) << brdf;  // no fireflies in 480 pixels
    }
}

}  // namespace
}  // namespace stratum
