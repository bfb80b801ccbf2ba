#include "shade/finish/finishes.h"

#include "shade/brdf_checks.h"
#include "shade/finish/named_brdf.h"

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

// Light that facets pass on among themselves was lost once: ln 2 of it from above at alpha 1.
TEST(Metal, AWhiteOneLosesAndGainsNothing) {
    for (const float alpha : {0.1f, 0.25f, 0.5f, 1.0f}) {
        const Metal brdf(Color(1.0f), alpha);
        for (const double cosine : {0.02, 0.1, 0.4, 0.7, 1.0}) {
            const int rings = alpha < 0.2f ? 3000 : 800;
            EXPECT_NEAR(test::albedo(brdf, test::direction(cosine, 0.4), rings, rings), 1.0, 3e-3)
                << alpha << " " << cosine;
        }
    }
    // Narrow lobes by their own samples. The nodes of the table are far apart where a smooth surface is grazed.
    for (const float alpha : {0.001f, 0.05f, 0.25f, 1.0f})
        for (const double cosine : {0.001, 0.01, 0.1, 0.4, 0.7, 1.0})
            EXPECT_NEAR(test::sampledAlbedo(Metal(Color(1.0f), alpha), test::direction(cosine, 0.4)), 1.0,
                        alpha < 0.01f && cosine < 0.1 ? 1e-2 : 2e-3)
                << alpha << " " << cosine;
}

TEST(Metal, AColoredOneKeepsLessThanAWhiteOne) {
    for (const float alpha : {0.25f, 1.0f})
        for (const double cosine : {0.1, 0.5, 1.0}) {
            const glm::vec3 wo = test::direction(cosine, 0.4);
            double last = 0.0;
            for (const float color : {0.0f, 0.3f, 0.6f, 0.9f, 1.0f}) {
                const double albedo = test::albedo(Metal(Color(color), alpha), wo, 800, 800);
                EXPECT_GT(albedo, last) << alpha << " " << cosine;
                EXPECT_LE(albedo, 1.002);
                last = albedo;
            }
        }
}

TEST(Metal, SamplesItsDensity) {
    for (const float alpha : {0.15f, 0.4f, 1.0f}) {
        const Metal brdf(Color(0.5f), alpha);
        for (const double c : {0.1, 0.5, 0.95})
            EXPECT_LT(test::chiSquaredZ(brdf, test::direction(c, 1.0), 400000, 3), 4.0) << alpha << " " << c;
    }
}

TEST(Metal, IsAMaterialOfTheCommandLine) {
    const auto brdf = shade::makeBrdf("metal:0.9,0.7,0.4,0.02");
    const glm::vec3 up(0.0f, 0.0f, 1.0f);
    const Color straight = brdf->eval(up, up);
    EXPECT_NEAR(straight.g / straight.r, 0.7f / 0.9f, 1e-3f);
    const auto other = brdf->recolored(Color(0.1f, 0.2f, 0.3f));
    ASSERT_TRUE(other);
    EXPECT_NEAR(other->eval(up, up).b / other->eval(up, up).r, 3.0f, 3e-3f);
}

}  // namespace
}  // namespace stratum
