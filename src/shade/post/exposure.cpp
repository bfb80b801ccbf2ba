#include "shade/post/exposure.h"

#include "shade/integrator/bare_light.h"

#include <algorithm>
#include <cmath>

namespace stratum::shade {
namespace {

/// Radiance of the white surface after exposure. Slightly below kStudioLevel, so that surfaces in direct sun keep their
/// color.
constexpr double kLevel = 1.3;

}  // namespace

double automaticExposure(const SceneDescription& scene, const glm::dvec3& point) {
    const BareLight light(scene, point);
    const double level = static_cast<double>(light.brightest() * std::max(light.matt({0.0f, 0.0f, 1.0f}), 0.75f));
    if (!(level > 0.0) || !std::isfinite(level)) return 0.0;
    return std::clamp(std::log2(kLevel / level), -30.0, 30.0);
}

}  // namespace stratum::shade
