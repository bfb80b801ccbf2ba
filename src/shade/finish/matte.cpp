#include "shade/finish/matte.h"

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

}  // namespace stratum::shade
