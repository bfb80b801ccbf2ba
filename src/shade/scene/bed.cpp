#include "shade/scene/bed.h"

#include <algorithm>

namespace stratum::shade {

Color Backdrop::radiance(const glm::vec3& direction) const {
    const float t = std::clamp(direction.z, 0.0f, 1.0f);
    const float w = t * t * (3.0f - 2.0f * t);
    return (1.0f - w) * horizon + w * zenith;
}

double Bed::fadeAt(double radius) const {
    const double t = std::clamp((radius - fade_begin) / (fade_end - fade_begin), 0.0, 1.0);
    return t * t * t * (t * (6.0 * t - 15.0) + 10.0);
}

}  // namespace stratum::shade
