#include "shade/brdf/gloss_mixture.h"

#include "shade/brdf_checks.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

using shade::Color;

/// A matt surface that is drawn from by the mixture.
class Mixed final : public shade::Brdf {
public:
    Mixed(float alpha, float share) : mixture_{shade::Ggx(alpha), share} {}
    Color eval(const glm::vec3&, const glm::vec3&) const override { return Color(0.5f * shade::kInvPi); }
    std::optional<shade::BrdfSample> sample(const glm::vec3& wo, float lobe, const glm::vec2& u) const override {
        return mixture_.sample(*this, wo, lobe, u);
    }
    float pdf(const glm::vec3& wo, const glm::vec3& wi) const override { return mixture_.pdf(wo, wi); }

private:
    shade::GlossMixture mixture_;
};

TEST(GlossMixture, SamplesItsDensityForEveryShare) {
    for (const float share : {0.0f, 0.3f, 1.0f})
        for (const float alpha : {0.15f, 0.6f})
            for (const double c : {0.1, 0.8}) {
                const Mixed brdf(alpha, share);
                EXPECT_LT(test::chiSquaredZ(brdf, test::direction(c, 1.0), 200000, 3), 4.0) << share << " " << alpha;
            }
}

TEST(GlossMixture, FindsAllThatAMattSurfaceReflects) {
    // As long as some samples go by the cosine.
    for (const float share : {0.0f, 0.5f})
        EXPECT_NEAR(test::sampledAlbedo(Mixed(0.3f, share), test::direction(0.6, 0.2)), 0.5, 2e-3) << share;
}

TEST(GlossMixture, GivesNothingBelowTheSurface) {
    const shade::GlossMixture mixture{shade::Ggx(0.3f), 0.5f};
    EXPECT_EQ(mixture.pdf({0, 0, 1}, {0, 0.6f, -0.8f}), 0.0f);
    EXPECT_EQ(mixture.pdf({0, 0.6f, -0.8f}, {0, 0, 1}), 0.0f);
    EXPECT_FALSE(mixture.sample(Mixed(0.3f, 0.5f), {0, 0.6f, -0.8f}, 0.1f, {0.5f, 0.5f}));
}

}  // namespace
}  // namespace stratum
