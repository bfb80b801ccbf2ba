// Ideal diffuse reflection.
#pragma once

#include "shade/brdf/brdf.h"

namespace stratum::shade {

/// f = albedo / pi.
class Lambert final : public Brdf {
public:
    /// @param albedo  in [0, 1]
    explicit Lambert(const Color& albedo);
    Color eval(const glm::vec3& wo, const glm::vec3& wi) const override;
    std::optional<BrdfSample> sample(const glm::vec3& wo, float lobe, const glm::vec2& u) const override;
    float pdf(const glm::vec3& wo, const glm::vec3& wi) const override;
    std::shared_ptr<const Brdf> recolored(const Color& albedo) const override {
        return std::make_shared<Lambert>(albedo);
    }

private:
    Color f_;
};

}  // namespace stratum::shade
