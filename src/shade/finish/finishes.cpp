#include "shade/finish/finishes.h"

#include "shade/brdf/gloss_mixture.h"
#include "shade/camera/sampling.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace stratum::shade {

Matte::Matte(const Color& body, float roughness) : body_(body), roughness_(roughness) {
    constexpr float kOfScale = 0.5f - 2.0f / (3.0f * kPi);
    constexpr float kOfMean = 2.0f / 3.0f - 28.0f / (15.0f * kPi);
    scale_ = 1.0f / (1.0f + kOfScale * roughness);
    mean_ = scale_ * (1.0f + kOfMean * roughness);
    again_ = body * body * mean_ / (Color(1.0f) - body * (1.0f - mean_));
}

float Matte::firstAlbedo(float cosine) const {
    const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
    // (1 - sine^3) / cosine without the difference, which has no digits at grazing angles.
    const float grazing = cosine * (1.0f + sine + sine * sine) / (1.0f + sine);
    const float g = sine * (std::acos(std::min(cosine, 1.0f)) - sine * cosine) + 2.0f / 3.0f * (sine * grazing - sine);
    return scale_ * (1.0f + roughness_ * g * kInvPi);
}

Color Matte::eval(const glm::vec3& wo, const glm::vec3& wi) const {
    if (!(GlossMixture::above(wo) && GlossMixture::above(wi))) return Color(0.0f);
    const float s = wo.x * wi.x + wo.y * wi.y;
    const float ratio = s > 0.0f ? s / std::max(wo.z, wi.z) : s;
    const float once = scale_ * (1.0f + roughness_ * ratio) * kInvPi;
    const float lost = std::max(1e-7f, 1.0f - mean_);  // 0 of a smooth surface, and so are the other two
    const float more =
        std::max(0.0f, 1.0f - firstAlbedo(wo.z)) * std::max(0.0f, 1.0f - firstAlbedo(wi.z)) / lost * kInvPi;
    return body_ * std::max(0.0f, once) + again_ * more;
}

float Matte::pdf(const glm::vec3& wo, const glm::vec3& wi) const {
    return GlossMixture::above(wo) && GlossMixture::above(wi) ? wi.z * kInvPi : 0.0f;
}

std::optional<BrdfSample> Matte::sample(const glm::vec3& wo, float, const glm::vec2& u) const {
    const glm::vec3 wi = toCosineHemisphere(u);
    const float density = pdf(wo, wi);
    if (!(density > 0.0f)) return std::nullopt;
    return BrdfSample{wi, eval(wo, wi), density};
}

std::shared_ptr<const Brdf> Matte::recolored(const Color& body) const {
    return std::make_shared<Matte>(body, roughness_);
}

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

Color Silk::eval(const glm::vec3& wo, const glm::vec3& wi) const {
    return kPlatelets * platelets_.eval(wo, wi) + (1.0f - kPlatelets) * plastic_.eval(wo, wi);
}

float Silk::pdf(const glm::vec3& wo, const glm::vec3& wi) const {
    return kPlatelets * platelets_.pdf(wo, wi) + (1.0f - kPlatelets) * plastic_.pdf(wo, wi);
}

std::optional<BrdfSample> Silk::sample(const glm::vec3& wo, float lobe, const glm::vec2& u) const {
    const bool platelet = lobe < kPlatelets;
    const std::optional<BrdfSample> drawn = platelet
                                                ? platelets_.sample(wo, lobe / kPlatelets, u)
                                                : plastic_.sample(wo, (lobe - kPlatelets) / (1.0f - kPlatelets), u);
    if (!drawn) return std::nullopt;
    const float density = pdf(wo, drawn->wi);
    if (!(density > 0.0f)) return std::nullopt;
    return BrdfSample{drawn->wi, eval(wo, drawn->wi), density};
}

std::shared_ptr<const Brdf> Silk::recolored(const Color& body) const {
    auto other = std::make_shared<Silk>(*this);  // the tables don't depend on the body
    other->platelets_ = static_cast<const Metal&>(*platelets_.recolored(body));
    other->plastic_ = static_cast<const Plastic&>(*plastic_.recolored(body));
    return other;
}

}  // namespace stratum::shade
