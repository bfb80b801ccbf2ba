#include "shade/brdf/albedo_table.h"

#include "shade/brdf_checks.h"

#include <gtest/gtest.h>

#include <cmath>

namespace stratum {
namespace {

TEST(AlbedoTable, KnowsWhatIsReflectedOnce) {
    const auto once = shade::AlbedoTable::ofMirrors(shade::Ggx{1.0f});
    EXPECT_NEAR(once.at({0, 0, 1}), 1.0f - std::log(2.0f), 1e-3f);  // in closed form
    // The rest has the albedo that is lacking.
    for (const float cosine : {0.1f, 0.5f, 1.0f}) {
        const glm::vec3 wo = test::direction(static_cast<double>(cosine), 0.0);
        const double rest = test::overHemisphere(
            [&](const glm::vec3& wi) { return static_cast<double>(once.rest(wo, wi) * wi.z); }, 800, 16);
        EXPECT_NEAR(rest, 1.0 - static_cast<double>(once.at(wo)), 1e-3) << cosine;
    }
}

// In vectors it must be what the samples of Ggx give one by one.
TEST(AlbedoTable, IsTheMeanOverVisibleNormals) {
    const auto mean = [](const shade::Ggx& ggx, const glm::vec3& wo, int rings, int angles) {
        double sum = 0.0;
        for (int i = 0; i < rings; ++i)
            for (int j = 0; j < angles; ++j) {
                const glm::vec2 u((static_cast<float>(j) + 0.5f) / static_cast<float>(angles),
                                  (static_cast<float>(i) + 0.5f) / static_cast<float>(rings));
                const glm::vec3 h = ggx.sampleVisible(wo, u);
                const float c = glm::dot(wo, h);
                const glm::vec3 wi = 2.0f * c * h - wo;
                if (c > 0.0f && wi.z > 0.0f)
                    sum += static_cast<double>(shade::fresnelDielectric(c, 1.5f) * ggx.shadowing(wo, wi));
            }
        return sum / (rings * angles);
    };
    for (const shade::Ggx& ggx : {shade::Ggx(0.1f), shade::Ggx(0.6f), shade::Ggx(0.2f, 0.5f)}) {
        const auto table = shade::AlbedoTable::ofDielectric(ggx, 1.5f);
        const double tolerance = ggx.isotropic() ? 3e-4 : 1e-3;  // of its quadrature
        for (const float s : {0.5f, 0.75f, 1.0f})                // nodes of the table: cosine^(1/4)
            for (const double azimuth : {0.0, 0.5 * static_cast<double>(shade::kPi)}) {
                const glm::vec3 wo = test::direction(std::pow(static_cast<double>(s), 4.0), azimuth);
                EXPECT_NEAR(table.at(wo), mean(ggx, wo, 96, 512), tolerance) << s << " " << azimuth;
            }
    }
}

}  // namespace
}  // namespace stratum
