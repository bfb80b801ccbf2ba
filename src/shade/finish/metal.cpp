#include "shade/finish/metal.h"

#include <glm/geometric.hpp>

#include <algorithm>

namespace stratum::shade {

Metal::Metal(const Color& color, float alpha) : ggx_(alpha), once_(AlbedoTable::ofMirrors(ggx_)) { setColor(color); }

void Metal::setColor(const Color& color) {
    color_ = color;
    // The mean of Schlick's formula over the hemisphere.
    const Color mean = color + (Color(1.0f) - color) / 21.0f;
    const float lost = once_.oneMinusMean();
    further_ = mean * mean * (1.0f - lost) / (Color(1.0f) - mean * lost);
}

Color Metal::eval(const glm::vec3& wo, const glm::vec3& wi) const {
    if (!(GlossMixture::above(wo) && GlossMixture::above(wi))) return Color(0.0f);
    const glm::vec3 h = glm::normalize(wo + wi);
    // wo.h and wi.h are equal except for rounding; with their mean f(a, b) and f(b, a) are bit-identical.
    const float c = std::clamp(0.5f * (glm::dot(wo, h) + glm::dot(wi, h)), 0.0f, 1.0f);
    const float off = 1.0f - c;
    const float grazing = off * off * off * off * off;
    const Color once = (color_ + (Color(1.0f) - color_) * grazing) * (ggx_.d(h) * ggx_.visibility(wo, wi));
    return once + further_ * once_.rest(wo, wi);
}

GlossMixture Metal::mixture(const glm::vec3& wo) const {
    const float once = once_.at(wo);
    const float further = maxComponent(further_) * (1.0f - once);
    return {ggx_, once / (once + further)};
}

float Metal::pdf(const glm::vec3& wo, const glm::vec3& wi) const { return mixture(wo).pdf(wo, wi); }

std::optional<BrdfSample> Metal::sample(const glm::vec3& wo, float lobe, const glm::vec2& u) const {
    return mixture(wo).sample(*this, wo, lobe, u);
}

std::shared_ptr<const Brdf> Metal::recolored(const Color& body) const {
    auto other = std::make_shared<Metal>(*this);  // the table does not depend on the colour
    other->setColor(body);
    return other;
}

}  // namespace stratum::shade
