#include "shade/brdf/plastic.h"

#include "shade/brdf_checks.h"

#include <gtest/gtest.h>

#include <random>

namespace stratum {
namespace {

using shade::Color;
using shade::Plastic;

constexpr float kAlphas[] = {0.1f, 0.2f, 0.3f, 0.5f, 1.0f};
constexpr double kCosines[] = {0.02, 0.1, 0.3, 0.6, 0.9, 1.0};

TEST(Plastic, IsReciprocal) {
    for (const float alpha : {0.001f, 0.05f, 0.25f, 1.0f})
        EXPECT_LT(test::asymmetry(Plastic(Color(0.8f, 0.4f, 0.1f), alpha)), 1e-6) << alpha;
}

TEST(Plastic, WhiteBodyLosesAndGainsNothing) {
    for (const float alpha : kAlphas) {
        const Plastic brdf(Color(1.0f), alpha);
        for (const double c : kCosines) {
            const int rings = alpha < 0.2f ? 3000 : 800;
            const double a = test::albedo(brdf, test::direction(c, 0.4), rings, rings);
            EXPECT_NEAR(a, 1.0, 1.5e-3) << "alpha " << alpha << " cosine " << c;
        }
    }
}

TEST(Plastic, AlbedoStaysBelowOne) {
    // By its own samples: exact for narrow lobes too, where quadrature over angles is not.
    for (const float alpha : {0.001f, 0.01f, 0.05f, 0.15f, 0.25f, 0.5f, 1.0f}) {
        const Plastic brdf(Color(1.0f), alpha);
        for (const double c : {0.001, 0.01, 0.05, 0.1, 0.2, 0.4, 0.7, 1.0})
            EXPECT_LE(test::sampledAlbedo(brdf, test::direction(c, 0.4)), 1.001) << alpha << " " << c;
    }
}

TEST(Plastic, BlackBodyReflectsTheCoatAlone) {
    for (const float alpha : {0.2f, 0.5f, 1.0f}) {
        const Plastic brdf(Color(0.0f), alpha);
        for (const double c : kCosines)
            EXPECT_NEAR(test::albedo(brdf, test::direction(c, 0.4), 800, 800),
                        double(brdf.coatAlbedo(test::direction(c, 0.0))), 1e-3);
    }
    // A smooth coat is Fresnel's: 4 % at normal incidence for eta 1.5.
    EXPECT_NEAR(Plastic(Color(0.0f), 0.001f).coatAlbedo({0, 0, 1}), 0.04f, 1e-4f);
}

TEST(Plastic, SamplesAgreeWithQuadrature) {
    for (const float alpha : {0.1f, 0.25f, 0.6f}) {
        const Plastic brdf(Color(0.5f), alpha);
        for (const double c : {0.1, 0.4, 0.95}) {
            const glm::vec3 wo = test::direction(c, 2.0);
            const int rings = alpha < 0.2f ? 3000 : 800;
            EXPECT_NEAR(test::sampledAlbedo(brdf, wo), test::albedo(brdf, wo, rings, rings), 4e-3) << alpha << " " << c;
        }
    }
}

TEST(Plastic, SamplesItsDensity) {
    for (const float alpha : {0.15f, 0.4f, 1.0f}) {
        const Plastic brdf(Color(0.5f), alpha);
        for (const double c : {0.1, 0.5, 0.95})
            EXPECT_LT(test::chiSquaredZ(brdf, test::direction(c, 1.0), 400000, 3), 4.0) << alpha << " " << c;
    }
}

// sample() draws a half vector, and eval() makes it anew: roundings of 2^-24 over the lobe's width, to the fourth power
// of their sum. Also at grazing angles.
TEST(Plastic, SamplesHaveTheValuesOfTheirDirections) {
    for (const float alpha : {0.001f, 0.05f, 1.0f}) {
        const Plastic brdf(Color(0.5f), alpha);
        std::mt19937 random(3);
        std::uniform_real_distribution<float> unit(0.0f, 0x1.fffffep-1f);
        const double tolerance = 16 * 0x1p-24 / static_cast<double>(alpha);
        for (int n = 0; n < 20000; ++n) {
            const glm::vec3 wo = test::direction(n % 3 == 0 ? 1e-4 : static_cast<double>(unit(random)) + 1e-6, 0.2);
            const auto sample = brdf.sample(wo, unit(random), {unit(random), unit(random)});
            if (!sample) continue;
            const auto pdf = static_cast<double>(brdf.pdf(wo, sample->wi));
            ASSERT_NEAR(static_cast<double>(sample->pdf) / pdf, 1, tolerance) << alpha << " " << n;
            const auto f = static_cast<double>(brdf.eval(wo, sample->wi).r);
            if (f > 0) {
                ASSERT_NEAR(static_cast<double>(sample->f.r) / f, 1, tolerance) << alpha << " " << n;
            }
        }
    }
}

TEST(Plastic, DensityIntegratesToTheShareThatIsDrawn) {
    for (const float alpha : {0.2f, 0.5f}) {
        const Plastic brdf(Color(0.5f), alpha);
        const glm::vec3 wo = test::direction(0.95, 0.0);
        const double inside =
            test::overHemisphere([&](const glm::vec3& wi) { return double(brdf.pdf(wo, wi)); }, 1000, 1000);
        int drawn = 0;
        int total = 0;
        for (int i = 0; i < 100; ++i)
            for (int j = 0; j < 100; ++j)
                for (int k = 0; k < 10; ++k, ++total)
                    drawn += brdf.sample(wo, (k + 0.5f) / 10, {(i + 0.5f) / 100, (j + 0.5f) / 100}).has_value();
        EXPECT_NEAR(inside, double(drawn) / total, 2e-3);
        EXPECT_LE(inside, 1.0 + 1e-4);
    }
}

TEST(Plastic, IsFiniteAtTheEdges) {
    for (const float alpha : {0.001f, 0.2f, 1.0f}) {
        const Plastic brdf(Color(1.0f), alpha);
        for (const float z : {1e-30f, 1e-12f, 1e-6f, 1e-3f, 1.0f}) {
            const glm::vec3 wo(std::sqrt(1.0f - z * z), 0.0f, z);
            for (const glm::vec3& wi : {glm::vec3(-wo.x, 0.0f, z), glm::vec3(wo.x, 0.0f, z), glm::vec3(0, 0, 1)}) {
                EXPECT_TRUE(shade::isFinite(brdf.eval(wo, wi))) << alpha << " " << z;
                EXPECT_TRUE(std::isfinite(brdf.pdf(wo, wi)));
            }
            for (const float u : {0.0f, 0.3f, 0x1.fffffep-1f}) {
                const auto s = brdf.sample(wo, u, {u, u});
                if (!s) continue;
                EXPECT_GT(s->pdf, 0.0f);
                EXPECT_TRUE(shade::isFinite(s->f * (s->wi.z / s->pdf)));
            }
        }
        EXPECT_EQ(brdf.eval({0, 0, 1}, {0, 0, -1}), Color(0.0f));
        EXPECT_FALSE(brdf.sample({0, 0, -1}, 0.5f, {0.5f, 0.5f}));
    }
}

}  // namespace
}  // namespace stratum
