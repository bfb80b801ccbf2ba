#include "shade/brdf/gloss_mixture.h"

#include <cmath>

namespace stratum::shade {

float GlossMixture::pdf(const glm::vec3& wo, const glm::vec3& wi) const {
    if (!(above(wo) && above(wi))) return 0.0f;
    return share * ggx.pdfReflected(wo, glm::normalize(wo + wi)) + (1.0f - share) * wi.z * kInvPi;
}

BrdfSample GlossMixture::draw(const glm::vec3& wo, float lobe, const glm::vec2& u) const {
    if (!above(wo)) return {};
    glm::vec3 wi;
    if (lobe < share) {
        const glm::vec3 h = ggx.sampleVisible(wo, u);
        wi = glm::normalize(2.0f * glm::dot(wo, h) * h - wo);
    } else {
        wi = toCosineHemisphere(u);
    }
    const float density = pdf(wo, wi);
    if (!(density > 0.0f && std::isfinite(density))) return {};
    return {wi, Color(0.0f), density};
}

std::optional<BrdfSample> GlossMixture::sample(const Brdf& brdf, const glm::vec3& wo, float lobe,
                                               const glm::vec2& u) const {
    BrdfSample drawn = draw(wo, lobe, u);
    if (!(drawn.pdf > 0.0f)) return std::nullopt;
    drawn.f = brdf.eval(wo, drawn.wi);
    return drawn;
}

}  // namespace stratum::shade
