// A rectangular area light: a softbox, a window, a screen.
#pragma once

#include "shade/light/light.h"

namespace stratum::shade {

/// A rectangle of constant radiance that emits to both sides. Sampled by solid angle:
/// C. Urena, M. Fajardo, A. King, "An Area-Preserving Parametrization for Spherical Rectangles", EGSR 2013.
class RectangleLight final : public Light {
public:
    /// @param half_u, half_v  perpendicular. World units
    RectangleLight(const glm::dvec3& center, const glm::dvec3& half_u, const glm::dvec3& half_v, const Color& radiance);
    std::optional<LightSample> sample(const glm::dvec3& point, const glm::vec2& u) const override;
    std::optional<LightHit> intersect(const trace::Ray& ray) const override;
    bool hasExtent() const override { return true; }

private:
    struct View;
    View viewFrom(const glm::dvec3& point) const;

    glm::dvec3 center_, x_, y_, z_;  // unit axes; z is across
    double half_x_, half_y_;         // world units
    Color radiance_;
};

}  // namespace stratum::shade
