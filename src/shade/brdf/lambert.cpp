#include "shade/brdf/lambert.h"

#include "shade/camera/sampling.h"

namespace stratum::shade {

Lambert::Lambert(const Color& albedo) : f_(albedo * kInvPi) {}

Color Lambert::eval(const glm::vec3& wo, const glm::vec3& wi) const {
    return wo.z > 0.0f && wi.z > 0.0f ? f_ : Color(0.0f);
}

std::optional<BrdfSample> Lambert::sample(const glm::vec3& wo, float, const glm::vec2& u) const {
    const glm::vec3 wi = toCosineHemisphere(u);
    if (!(wo.z > 0.0f && wi.z > 0.0f)) return std::nullopt;
    return BrdfSample{wi, f_, wi.z * kInvPi};
}

float Lambert::pdf(const glm::vec3& wo, const glm::vec3& wi) const {
    return wo.z > 0.0f && wi.z > 0.0f ? wi.z * kInvPi : 0.0f;
}

}  // namespace stratum::shade
