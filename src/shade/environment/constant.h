// Constant environment light.
#pragma once

#include "shade/environment/environment.h"

namespace stratum::shade {

class ConstantEnvironment final : public Environment {
public:
    /// @param radiance  >= 0
    explicit ConstantEnvironment(const Color& radiance) : radiance_(radiance) {}
    Color radiance(const glm::vec3&) const override { return radiance_; }
    EnvironmentSample sample(int strategy, const glm::vec2& u, const glm::vec3& normal) const override;
    float pdf(const glm::vec3& direction, const glm::vec3& normal) const override;

private:
    Color radiance_;
};

}  // namespace stratum::shade
