// Lights at infinity: one direction, or a disc in the sky.
#pragma once

#include "shade/light/light.h"

namespace stratum::shade {

/// One direction, hard shadows. A white Lambert surface that faces it gets radiance irradiance / pi.
class DirectionalLight final : public Light {
public:
    /// @param to_light    towards the light, unit, world space
    /// @param irradiance  on a surface that faces the light
    DirectionalLight(const glm::vec3& to_light, const Color& irradiance)
        : to_light_(to_light), irradiance_(irradiance) {}
    std::optional<LightSample> sample(const glm::dvec3& point, const glm::vec2& u) const override;

private:
    glm::vec3 to_light_;
    Color irradiance_;
};

/// A disc of constant radiance in the sky: soft shadows, and highlights with a size.
class SunLight final : public Light {
public:
    static constexpr float kRealDiameter = 0.53f;  ///< degrees

    /// @param to_light    towards the middle, unit, world space
    /// @param irradiance  on a surface that faces it
    /// @param diameter    degrees, above 0 and at most 90
    SunLight(const glm::vec3& to_light, const Color& irradiance, float diameter);
    std::optional<LightSample> sample(const glm::dvec3& point, const glm::vec2& u) const override;
    std::optional<LightHit> intersect(const trace::Ray& ray) const override;
    bool hasExtent() const override { return true; }

private:
    glm::vec3 to_light_;
    Color radiance_;
    double lift_;  // 1 - cosine of the half angle; stored itself, because a float's 1 - cos would lose digits
    float pdf_;
};

}  // namespace stratum::shade
