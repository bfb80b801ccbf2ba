#include "shade/brdf/rough_interface.h"

#include "shade/brdf_checks.h"

#include <gtest/gtest.h>

#include <random>

namespace stratum {
namespace {

using shade::RoughInterface;
using shade::Side;

constexpr Side kSides[] = {Side::air, Side::solid};
constexpr double kInterfaceCosines[] = {0.05, 0.3, 0.6, 0.76, 0.95, 1.0};

TEST(RoughInterface, ScattersAllLight) {
    // Samples have weight 1: hardly one may be refused.
    constexpr std::uint32_t kSamples = 1u << 17;
    for (const float alpha : {0.001f, 0.1f, 0.22f, 0.5f, 1.0f})
        for (const float eta : {1.465f, 2.0f}) {
            const RoughInterface surface(eta, alpha);
            for (const Side side : kSides)
                for (const double cosine : kInterfaceCosines) {
                    double sum = 0.0;
                    shade::Sampler sampler(1, kSamples);
                    for (std::uint32_t i = 0; i < kSamples; ++i) {
                        sampler.start(static_cast<int>(i >> 16), 0, i & 0xffffu);
                        const glm::vec2 lobe = sampler.next2D();
                        if (surface.sample(side, test::direction(cosine, 0.4), lobe, sampler.next2D())) sum += 1.0;
                    }
                    EXPECT_NEAR(sum / kSamples, 1.0, 1e-4) << "alpha " << alpha << " eta " << eta << " side "
                                                           << static_cast<int>(side) << " cosine " << cosine;
                }
        }
}

TEST(RoughInterface, ItsValueIntegratesToOne) {
    // By quadrature over both sides, without sample().
    for (const float alpha : {0.3f, 0.6f}) {
        const RoughInterface surface(1.46f, alpha);
        for (const Side side : kSides)
            for (const double cosine : {0.3, 0.76, 1.0}) {
                const glm::vec3 wo = test::direction(cosine, 0.4);
                double sum = 0.0;
                for (const Side to : kSides) {
                    sum += test::overHemisphere(
                        [&](const glm::vec3& wi) { return static_cast<double>(surface.eval(side, wo, to, wi) * wi.z); },
                        800, 800);
                }
                EXPECT_NEAR(sum, 1.0, 2e-3) << alpha << " " << cosine;
            }
    }
}

TEST(RoughInterface, IsReciprocalInBasicRadiance) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(0.02, 1.0);
    for (const float alpha : {0.05f, 0.25f, 1.0f}) {
        const RoughInterface surface(1.5f, alpha);
        const auto index2 = [&](Side side) { return side == Side::air ? 1.0f : surface.eta() * surface.eta(); };
        for (int i = 0; i < 5000; ++i) {
            const glm::vec3 a = test::direction(uniform(random), 6.28 * uniform(random));
            const glm::vec3 b = test::direction(uniform(random), 6.28 * uniform(random));
            for (const Side from : kSides)
                for (const Side to : kSides) {
                    const float ab = surface.eval(from, a, to, b) / index2(to);
                    const float ba = surface.eval(to, b, from, a) / index2(from);
                    ASSERT_NEAR(ab, ba, 2e-4f * std::max(0.1f, ab));
                }
        }
    }
}

TEST(RoughInterface, SamplesFollowTheirDensity) {
    // Means over samples beside integrals over the density, on each side.
    const RoughInterface surface(1.46f, 0.4f);
    constexpr int kSamples = 400000;
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform(0.0f, 0x1.fffffep-1f);
    for (const Side from : kSides) {
        const glm::vec3 wo = test::direction(0.7, 1.1);
        double count[2] = {};
        double x[2] = {};
        double z[2] = {};
        for (int n = 0; n < kSamples; ++n) {
            const glm::vec2 lobe(uniform(random), uniform(random));
            const glm::vec2 u(uniform(random), uniform(random));
            const auto s = surface.sample(from, wo, lobe, u);
            if (!s) continue;
            const auto side = static_cast<std::size_t>(s->side);
            count[side] += 1.0 / kSamples;
            x[side] += static_cast<double>(s->wi.x) / kSamples;
            z[side] += static_cast<double>(s->wi.z) / kSamples;
            ASSERT_NEAR(s->pdf, surface.pdf(from, wo, s->side, s->wi), 1e-3f * s->pdf);
        }
        for (const Side to : kSides) {
            const auto mean = [&](const auto& weight) {
                return test::overHemisphere(
                    [&](const glm::vec3& wi) {
                        return static_cast<double>(surface.pdf(from, wo, to, wi)) * weight(wi);
                    },
                    600, 600);
            };
            const auto side = static_cast<std::size_t>(to);
            EXPECT_NEAR(count[side], mean([](const glm::vec3&) { return 1.0; }), 4e-3);
            EXPECT_NEAR(x[side], mean([](const glm::vec3& w) { return static_cast<double>(w.x); }), 4e-3);
            EXPECT_NEAR(z[side], mean([](const glm::vec3& w) { return static_cast<double>(w.z); }), 4e-3);
        }
    }
}

TEST(RoughInterface, SmoothGlassRefractsBySnellsLaw) {
    const RoughInterface glass(1.5f, 0.001f);
    const glm::vec3 wo = test::direction(0.6, 0.0);
    double through = 0.0;
    double bent = 0.0;
    constexpr int kSamples = 4000;
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(0.0f, 0x1.fffffep-1f);
    for (int n = 0; n < kSamples; ++n) {
        const glm::vec2 lobe(uniform(random), uniform(random));
        const auto s = glass.sample(Side::air, wo, lobe, {uniform(random), uniform(random)});
        ASSERT_TRUE(s);
        if (s->side == Side::air) continue;
        through += 1.0 / kSamples;
        // GGX has some steep facets however smooth it is.
        bent += std::abs(s->wi.x + 0.8f / 1.5f) > 0.01f ? 1.0 / kSamples : 0.0;
    }
    EXPECT_LT(bent, 0.02);
    EXPECT_NEAR(through, 1.0 - static_cast<double>(shade::fresnelDielectric(0.6f, 1.5f)), 0.02);
}

}  // namespace
}  // namespace stratum
