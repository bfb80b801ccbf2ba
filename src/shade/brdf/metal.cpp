#include "shade/brdf/metal.h"

#include "shade/brdf/gloss_mixture.h"

#include <glm/geometric.hpp>

#include <algorithm>

namespace stratum::shade {

Color Metal::eval(const glm::vec3& wo, const glm::vec3& wi) const {
    if (!(GlossMixture::above(wo) && GlossMixture::above(wi))) return Color(0.0f);
    const glm::vec3 h = glm::normalize(wo + wi);
    // wo.h and wi.h are equal except for rounding; with their mean f(a, b) and f(b, a) are bit-identical.
    const float c = std::clamp(0.5f * (glm::dot(wo, h) + glm::dot(wi, h)), 0.0f, 1.0f);
    const float off = 1.0f - c;
    const float grazing = off * off * off * off * off;
    return (color_ + (Color(1.0f) - color_) * grazing) * (ggx_.d(h) * ggx_.visibility(wo, wi));
}

float Metal::pdf(const glm::vec3& wo, const glm::vec3& wi) const { return GlossMixture{ggx_, 1.0f}.pdf(wo, wi); }

std::optional<BrdfSample> Metal::sample(const glm::vec3& wo, float lobe, const glm::vec2& u) const {
    return GlossMixture{ggx_, 1.0f}.sample(*this, wo, lobe, u);
}

std::shared_ptr<const Brdf> Metal::recolored(const Color& body) const {
    auto other = std::make_shared<Metal>(*this);
    other->color_ = body;
    return other;
}

}  // namespace stratum::shade
