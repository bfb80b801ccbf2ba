#include "shade/brdf/plastic.h"

#include "shade/brdf/gloss_mixture.h"

#include <cmath>

namespace stratum::shade {

Plastic::Plastic(const Color& body, const Ggx& coat)
    : body_(body), body_max_(maxComponent(body)), ggx_(coat), coat_(AlbedoTable::ofDielectric(ggx_, kEta)) {
    if (!coat.isotropic()) undirected_ = std::make_shared<Plastic>(body, std::sqrt(coat.along() * coat.across()));
}

std::shared_ptr<const Brdf> Plastic::recolored(const Color& body) const {
    auto other = std::make_shared<Plastic>(*this);  // the coat's table doesn't depend on the body
    other->body_ = body;
    other->body_max_ = maxComponent(body);
    if (undirected_) other->undirected_ = undirected_->recolored(body);
    return other;
}

float Plastic::coatShare(const glm::vec3& wo) const {
    // Proportional to the lobes' reflectances, but with more samples for the coat, which reflects small bright lights.
    const float e = coatAlbedo(wo);
    return std::max(e / (e + (1.0f - e) * body_max_), 0.3f);
}

float Plastic::coat(const glm::vec3& wo, const glm::vec3& wi, const glm::vec3& h) const {
    // wo.h and wi.h are equal except for rounding; with their mean f(a, b) and f(b, a) are bit-identical.
    const float c = std::max(0.0f, 0.5f * (glm::dot(wo, h) + glm::dot(wi, h)));
    return fresnelDielectric(c, kEta) * ggx_.d(h) * ggx_.visibility(wo, wi);
}

Color Plastic::eval(const glm::vec3& wo, const glm::vec3& wi) const {
    if (!(GlossMixture::above(wo) && GlossMixture::above(wi))) return Color(0.0f);
    return body_ * coat_.rest(wo, wi) + Color(coat(wo, wi, glm::normalize(wo + wi)));
}

float Plastic::pdf(const glm::vec3& wo, const glm::vec3& wi) const {
    return GlossMixture{ggx_, coatShare(wo)}.pdf(wo, wi);
}

std::optional<BrdfSample> Plastic::sample(const glm::vec3& wo, float lobe, const glm::vec2& u) const {
    return GlossMixture{ggx_, coatShare(wo)}.sample(*this, wo, lobe, u);
}

}  // namespace stratum::shade
