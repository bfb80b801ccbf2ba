#include "shade/finish/silk.h"

namespace stratum::shade {

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
