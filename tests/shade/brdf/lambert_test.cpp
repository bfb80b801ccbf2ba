#include "shade/brdf/lambert.h"

#include "shade/brdf_checks.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

using shade::Color;
using shade::Lambert;

TEST(Lambert, ReflectsItsAlbedo) {
    const Lambert brdf(Color(0.7f));
    for (const double c : {0.05, 0.5, 1.0}) {
        const glm::vec3 wo = test::direction(c, 0.3);
        EXPECT_NEAR(test::albedo(brdf, wo), 0.7, 1e-5);
        EXPECT_NEAR(test::sampledAlbedo(brdf, wo), 0.7, 1e-5);
    }
}

TEST(Lambert, SamplesItsDensity) {
    const Lambert brdf(Color(0.7f));
    const glm::vec3 wo = test::direction(0.4, 1.0);
    EXPECT_NEAR(test::overHemisphere([&](const glm::vec3& wi) { return double(brdf.pdf(wo, wi)); }, 512, 64), 1.0,
                1e-5);
    EXPECT_LT(test::chiSquaredZ(brdf, wo, 400000, 1), 4.0);
}

TEST(Lambert, IsReciprocalAndLosesNothingWhenWhite) {
    const Lambert brdf(Color(1.0f));
    for (const double c : {0.02, 0.4, 1.0}) {
        const glm::vec3 wo = test::direction(c, 0.3);
        EXPECT_NEAR(test::albedo(brdf, wo), 1.0, 1e-5);
        for (const double other : {0.1, 0.7, 1.0}) {
            const glm::vec3 wi = test::direction(other, 2.0);
            EXPECT_EQ(brdf.eval(wo, wi), brdf.eval(wi, wo));
        }
    }
}

TEST(Lambert, IsOpaque) {
    const Lambert brdf(Color(0.7f));
    const glm::vec3 above(0.0f, 0.0f, 1.0f);
    const glm::vec3 below(0.0f, 0.6f, -0.8f);
    EXPECT_EQ(brdf.eval(above, below), Color(0.0f));
    EXPECT_EQ(brdf.eval(below, above), Color(0.0f));
    EXPECT_EQ(brdf.pdf(above, below), 0.0f);
    EXPECT_FALSE(brdf.sample(below, 0.5f, {0.5f, 0.5f}));
    // The edge of the square is the horizon, where the density is 0.
    const auto edge = brdf.sample(above, 0.5f, {0.0f, 0.5f});
    EXPECT_TRUE(!edge || edge->pdf > 0.0f);
}

}  // namespace
}  // namespace stratum
