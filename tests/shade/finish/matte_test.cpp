#include "shade/finish/finishes.h"

#include "shade/brdf_checks.h"
#include "shade/finish/named_brdf.h"

#include <gtest/gtest.h>

#include <random>

namespace stratum {
namespace {

using shade::Color;
using shade::Matte;

TEST(Matte, IsReciprocal) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (const float roughness : {0.0f, 0.4f, 1.0f}) {
        const Matte brdf(Color(0.9f, 0.5f, 0.1f), roughness);
        for (int i = 0; i < 20000; ++i) {
            const glm::vec3 a = test::direction(uniform(random), 6.28 * uniform(random));
            const glm::vec3 b = test::direction(uniform(random), 6.28 * uniform(random));
            const Color ab = brdf.eval(a, b);
            const Color ba = brdf.eval(b, a);
            for (int c = 0; c < 3; ++c) {
                ASSERT_GE(ab[c], 0.0f);
                ASSERT_NEAR(ab[c], ba[c], 1e-6f);
            }
        }
    }
}

TEST(Matte, WhiteLosesNothing) {
    for (const float roughness : {0.0f, 0.3f, 0.8f, 1.0f})
        for (const double cosine : {0.02, 0.2, 0.5, 0.8, 1.0})
            EXPECT_NEAR(test::albedo(Matte(Color(1.0f), roughness), test::direction(cosine, 0.3)), 1.0, 2e-3)
                << roughness << " " << cosine;
}

TEST(Matte, GainsNothingInColor) {
    for (const float body : {0.05f, 0.5f, 0.95f})
        for (const double cosine : {0.05, 0.4, 1.0}) {
            const double albedo = test::albedo(Matte(Color(body)), test::direction(cosine, 0.0));
            EXPECT_LE(albedo, body + 2e-3);
            EXPECT_GT(albedo, 0.8 * static_cast<double>(body));
        }
}

TEST(Matte, SmoothIsLambertian) {
    const Matte brdf(Color(0.6f), 0.0f);
    for (const double cosine : {0.1, 0.6, 1.0})
        EXPECT_NEAR(brdf.eval(test::direction(cosine, 0.0), test::direction(0.4, 2.0)).r, 0.6 / 3.14159265, 1e-5);
}

TEST(Matte, RoughIsFlatterThanLambert) {
    // The full moon: of a surface lit from behind the viewer, the edge is about as bright as the middle.
    const Matte rough(Color(0.5f), 1.0f);
    const glm::vec3 edge = test::direction(0.3, 0.0);
    EXPECT_GT(rough.eval(edge, edge).r, 1.2f * rough.eval({0, 0, 1}, {0, 0, 1}).r);
}

TEST(Matte, SamplesItsDensity) {
    const Matte brdf(Color(0.5f));
    EXPECT_LT(test::chiSquaredZ(brdf, test::direction(0.5, 1.0), 400000, 3), 4.0);
    EXPECT_NEAR(test::sampledAlbedo(brdf, test::direction(0.5, 1.0)), test::albedo(brdf, test::direction(0.5, 1.0)),
                2e-3);
}

TEST(Matte, IsAMaterialOfTheCommandLine) {
    const auto brdf = shade::makeBrdf("matte:0.8,0.4,0.2");
    const glm::vec3 up(0.0f, 0.0f, 1.0f);
    EXPECT_GT(brdf->eval(up, up).r, 1.9f * brdf->eval(up, up).g);  // scattered again, colors grow deeper
    const auto other = brdf->recolored(Color(0.2f));
    ASSERT_TRUE(other);
    EXPECT_FLOAT_EQ(other->eval(up, up).r, other->eval(up, up).b);
}

}  // namespace
}  // namespace stratum
