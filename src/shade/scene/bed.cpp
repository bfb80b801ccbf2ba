#include "shade/scene/bed.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace stratum::shade {

Color Backdrop::radiance(const glm::vec3& direction) const {
    const float t = std::clamp(direction.z, 0.0f, 1.0f);
    const float w = t * t * (3.0f - 2.0f * t);
    return (1.0f - w) * horizon + w * zenith;
}

std::optional<double> Bed::intersect(const trace::Ray& ray) const {
    if (!(ray.direction.z < 0.0)) return std::nullopt;
    const double t = (z - ray.origin.z) / ray.direction.z;
    if (!(t >= ray.t_min && t <= ray.t_max)) return std::nullopt;
    return t;
}

double Bed::fade(const glm::dvec3& point) const {
    const double r = glm::length(glm::dvec2(point.x, point.y) - center);
    const double t = std::clamp((r - fade_begin) / (fade_end - fade_begin), 0.0, 1.0);
    return t * t * t * (t * (6.0 * t - 15.0) + 10.0);
}

}  // namespace stratum::shade
