#include "shade/light/point_light.h"

#include <glm/geometric.hpp>

namespace stratum::shade {

std::optional<LightSample> PointLight::sample(const glm::dvec3& point, const glm::vec2&) const {
    const glm::dvec3 way = position_ - point;
    const double distance = glm::length(way);
    if (!(distance > 0.0)) return std::nullopt;
    const Color light = intensity_ * static_cast<float>(1.0 / (distance * distance));
    if (!isFinite(light)) return std::nullopt;
    return LightSample{glm::vec3(way / distance), distance, light, 0.0f};
}

}  // namespace stratum::shade
