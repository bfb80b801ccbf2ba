#include "shade/finish/glitter.h"

#include "shade/brdf_checks.h"
#include "shade/finish/named_brdf.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

namespace stratum {
namespace {

using shade::Brdf;
using shade::Color;
using shade::FlakePair;
using shade::Glitter;

TEST(Glitter, ItsFlakesAreReciprocal) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    const FlakePair brdf(Color(0.9f, 0.5f, 0.1f), {0.2f, -0.1f}, 0.3f);
    const Glitter glitter(Color(0.5f));
    for (int i = 0; i < 20000; ++i) {
        const glm::vec3 a = test::direction(uniform(random), 6.28 * uniform(random));
        const glm::vec3 b = test::direction(uniform(random), 6.28 * uniform(random));
        const Brdf& spot = glitter.at({0.15 * i, 0, 0});
        for (int c = 0; c < 3; ++c) {
            ASSERT_NEAR(brdf.eval(a, b)[c], brdf.eval(b, a)[c], 1e-5f * std::max(1.0f, brdf.eval(a, b)[c]));
            ASSERT_NEAR(spot.eval(a, b)[c], spot.eval(b, a)[c], 1e-5f * std::max(1.0f, spot.eval(a, b)[c]));
        }
    }
}

TEST(Glitter, NoPairOfFlakesGainsAnything) {
    // Also not a single steep one from the side.
    for (const float slope : {0.0f, 0.2f, 0.7f, 2.0f})
        for (const float alpha : {0.06f, 0.3f})
            for (const double cosine : {0.02, 0.2, 0.6, 1.0})
                for (const double azimuth : {0.0, 0.8, 3.0}) {
                    const FlakePair brdf(Color(1.0f), {slope, 0.0f}, alpha);
                    const double albedo = test::sampledAlbedo(brdf, test::direction(cosine, azimuth), 1u << 16);
                    EXPECT_LE(albedo, 1.002) << slope << " " << alpha << " " << cosine << " " << azimuth;
                }
    // Almost flat ones lose almost nothing.
    EXPECT_GT(test::sampledAlbedo(FlakePair(Color(1.0f), {0.05f, 0.0f}, 0.06f), test::direction(0.8, 0.0)), 0.98);
}

TEST(Glitter, QuadratureAgreesWithSampling) {
    const FlakePair flakes(Color(1.0f), {0.3f, 0.1f}, 0.25f);
    for (const double cosine : {0.3, 0.9}) {
        const glm::vec3 wo = test::direction(cosine, 0.5);
        EXPECT_NEAR(test::albedo(flakes, wo, 1024, 1024), test::sampledAlbedo(flakes, wo), 3e-3) << cosine;
    }
    const Glitter glitter(Color(1.0f));
    double mean = 0.0;
    constexpr int kPlaces = 64;
    const glm::vec3 wo = test::direction(0.7, 0.5);
    for (int n = 0; n < kPlaces; ++n)
        mean += test::sampledAlbedo(glitter.at({0.2 * n, 1.0, 2.0}), wo, 1u << 12) / kPlaces;
    EXPECT_GT(mean, 0.9);
    EXPECT_LE(mean, 1.001);
}

// None of its places is a dark hole in the white.
TEST(Glitter, NoFlakeIsDark) {
    const Glitter glitter(Color(1.0f), 0.5);
    std::set<const Brdf*> seen;
    for (int n = 0; n < 1500; ++n) {
        const Brdf& spot = glitter.at({0.5 * n + 0.1, -7.0, 3.0});
        if (!seen.insert(&spot).second) continue;
        for (const double cosine : {1.0, 0.7})
            ASSERT_GT(test::sampledAlbedo(spot, test::direction(cosine, 0.5), 1u << 12), 0.7) << n << " " << cosine;
    }
}

TEST(Glitter, SamplesItsDensity) {
    const FlakePair flakes(Color(0.5f), {0.3f, 0.1f}, 0.3f);
    for (const double c : {0.3, 0.95})
        EXPECT_LT(test::chiSquaredZ(flakes, test::direction(c, 1.0), 400000, 3), 4.0) << c;
    const Glitter glitter(Color(0.5f));
    EXPECT_LT(test::chiSquaredZ(glitter.at({1.0, 2.0, 3.0}), test::direction(0.8, 1.0), 400000, 3), 4.0);
}

TEST(Glitter, TheMeanOfPlacesIsWhatItIsWithoutOne) {
    const Glitter glitter(Color(0.2f, 0.1f, 0.4f));
    const glm::vec3 wo = test::direction(0.8, 0.0);
    const glm::vec3 wi = test::direction(0.7, 2.9);
    double mean = 0.0;
    constexpr int kPlaces = 40000;
    for (int n = 0; n < kPlaces; ++n)
        mean += static_cast<double>(glitter.at({0.15 * (n % 200), 0.15 * (n / 200), 0.3}).eval(wo, wi).g) / kPlaces;
    EXPECT_NEAR(mean / static_cast<double>(glitter.eval(wo, wi).g), 1.0, 0.1);
}

TEST(Glitter, AFlashStaysWhereItIs) {
    const Glitter glitter(Color(0.3f), 0.5);
    EXPECT_TRUE(glitter.variesByPlace());
    EXPECT_EQ(&glitter.at({0.6, 0.6, 0.6}), &glitter.at({0.9, 0.55, 0.99}));  // one cube
    std::set<const Brdf*> seen;
    for (int n = 0; n < 200; ++n) seen.insert(&glitter.at({0.5 * n + 0.1, -7.0, 3.0}));
    EXPECT_GT(seen.size(), 120u);
    // Places that are no numbers are none that break.
    EXPECT_NE(&glitter.at({NAN, 1e300, -1e300}), nullptr);
    // A flash is far brighter than the plastic around it.
    const glm::vec3 up(0.0f, 0.0f, 1.0f);
    float brightest = 0.0f;
    for (int n = 0; n < 2000; ++n) brightest = std::max(brightest, glitter.at({0.5 * n, 0, 0}).eval(up, up).g);
    EXPECT_GT(brightest, 5.0f * glitter.eval(up, up).g);
}

TEST(Glitter, IsAMaterialOfTheCommandLine) {
    const auto brdf = shade::makeBrdf("glitter:0.1,0.2,0.3,0.4");
    EXPECT_TRUE(brdf->variesByPlace());
    EXPECT_TRUE(brdf->recolored(Color(0.5f))->variesByPlace());
    EXPECT_THROW((void)shade::makeBrdf("glitter:0.1,0.2"), std::exception);
    EXPECT_THROW((void)shade::makeBrdf("glitter:0.1,0.2,0.3,99"), std::exception);
    EXPECT_FALSE(shade::makeBrdf("plastic:0.1,0.2,0.3,0.4")->variesByPlace());
}

}  // namespace
}  // namespace stratum
