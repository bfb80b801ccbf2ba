// A point light.
#pragma once

#include "shade/light/light.h"

namespace stratum::shade {

/// The same intensity in all directions, hard shadows; irradiance falls with the squared distance.
class PointLight final : public Light {
public:
    /// @param intensity  irradiance times squared distance (world units)
    PointLight(const glm::dvec3& position, const Color& intensity) : position_(position), intensity_(intensity) {}
    std::optional<LightSample> sample(const glm::dvec3& point, const glm::vec2& u) const override;

private:
    glm::dvec3 position_;
    Color intensity_;
};

}  // namespace stratum::shade
