#include "shade/brdf/metal.h"

#include "shade/brdf_checks.h"

#include <gtest/gtest.h>

#include <cmath>

namespace stratum {
namespace {

using shade::Color;
using shade::Metal;

TEST(Metal, IsReciprocal) {
    for (const float alpha : {0.001f, 0.05f, 0.25f, 1.0f})
        EXPECT_LT(test::asymmetry(Metal(Color(0.9f, 0.7f, 0.4f), alpha)), 1e-6) << alpha;
}

TEST(Metal, AMirrorReflectsItsColor) {
    // Almost smooth, from above: the reflectance at normal incidence; from the side almost all.
    const Metal brdf(Color(0.6f), 0.02f);
    EXPECT_NEAR(test::sampledAlbedo(brdf, test::direction(1.0, 0.0)), 0.6, 1e-3);
    EXPECT_GT(test::sampledAlbedo(brdf, test::direction(0.05, 0.0)), 0.8);
}

TEST(Metal, GainsNothingAndLosesWhatIsReflectedTwice) {
    for (const float alpha : {0.001f, 0.05f, 0.25f, 0.5f, 1.0f})
        for (const double cosine : {0.01, 0.1, 0.4, 0.7, 1.0}) {
            const double albedo = test::sampledAlbedo(Metal(Color(1.0f), alpha), test::direction(cosine, 0.4));
            EXPECT_LE(albedo, 1.001) << alpha << " " << cosine;
            EXPECT_GT(albedo, alpha <= 0.25f && cosine > 0.3 ? 0.84 : 0.3) << alpha << " " << cosine;
        }
    // Known in closed form.
    EXPECT_NEAR(test::sampledAlbedo(Metal(Color(1.0f), 1.0f), test::direction(1.0, 0.0)), 1.0 - std::log(2.0), 2e-3);
}

TEST(Metal, SamplesItsDensity) {
    for (const float alpha : {0.15f, 0.4f, 1.0f}) {
        const Metal brdf(Color(0.5f), alpha);
        for (const double c : {0.1, 0.5, 0.95})
            EXPECT_LT(test::chiSquaredZ(brdf, test::direction(c, 1.0), 400000, 3), 4.0) << alpha << " " << c;
    }
}

TEST(Metal, IsAMaterialOfTheCommandLine) {
    const auto brdf = shade::makeBrdf("metal:0.9,0.7,0.4,0.3");
    const glm::vec3 up(0.0f, 0.0f, 1.0f);
    const Color straight = brdf->eval(up, up);
    EXPECT_NEAR(straight.g / straight.r, 0.7f / 0.9f, 1e-5f);
    const auto other = brdf->recolored(Color(0.1f, 0.2f, 0.3f));
    ASSERT_TRUE(other);
    EXPECT_NEAR(other->eval(up, up).b / other->eval(up, up).r, 3.0f, 1e-4f);
}

}  // namespace
}  // namespace stratum
