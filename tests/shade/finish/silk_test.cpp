#include "shade/finish/finishes.h"

#include "shade/brdf_checks.h"
#include "shade/finish/named_brdf.h"

#include <gtest/gtest.h>

#include <random>

namespace stratum {
namespace {

using shade::Color;
using shade::Silk;

TEST(Silk, IsReciprocal) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    const Silk brdf(Color(0.9f, 0.5f, 0.1f));
    for (int i = 0; i < 20000; ++i) {
        const glm::vec3 a = test::direction(uniform(random), 6.28 * uniform(random));
        const glm::vec3 b = test::direction(uniform(random), 6.28 * uniform(random));
        const Color ab = brdf.eval(a, b);
        const Color ba = brdf.eval(b, a);
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(ab[c], ba[c], 1e-6f * std::max(1.0f, ab[c]));
    }
}

TEST(Silk, GainsNothing) {
    for (const double cosine : {0.01, 0.1, 0.4, 0.7, 1.0}) {
        const double albedo = test::sampledAlbedo(Silk(Color(1.0f)), test::direction(cosine, 0.4));
        EXPECT_LE(albedo, 1.001) << cosine;
        EXPECT_GT(albedo, 0.75) << cosine;
    }
}

TEST(Silk, QuadratureAgreesWithSampling) {
    const Silk brdf(Color(0.7f));
    for (const double cosine : {0.3, 0.9}) {
        const glm::vec3 wo = test::direction(cosine, 0.0);
        EXPECT_NEAR(test::albedo(brdf, wo, 1024, 1024), test::sampledAlbedo(brdf, wo), 3e-3) << cosine;
    }
}

TEST(Silk, SamplesItsDensity) {
    const Silk brdf(Color(0.5f));
    for (const double c : {0.3, 0.95}) EXPECT_LT(test::chiSquaredZ(brdf, test::direction(c, 1.0), 400000, 3), 4.0) << c;
}

TEST(Silk, ShinesInItsColor) {
    // Where plastic mirrors the lamp in white, silk does in its own color.
    const auto silk = shade::makeBrdf("silk:0.8,0.4,0.1");
    const auto plastic = shade::makeBrdf("plastic:0.8,0.4,0.1,0.1");
    const glm::vec3 a = test::direction(0.8, 0.0);
    const glm::vec3 b = test::direction(0.8, 3.14159265);
    const auto blue_share = [&](const shade::Brdf& brdf) { return brdf.eval(a, b).b / brdf.eval(a, b).r; };
    EXPECT_LT(blue_share(*silk), 0.6f * blue_share(*plastic));
    const auto other = silk->recolored(Color(0.1f, 0.4f, 0.8f));
    ASSERT_TRUE(other);
    EXPECT_GT(other->eval(a, b).b, 1.2f * other->eval(a, b).r);
}

}  // namespace
}  // namespace stratum
