// Automatic exposure from the light of a scene.
#pragma once

#include "shade/scene/scene.h"

#include <glm/vec3.hpp>

namespace stratum::shade {

/// Exposure in stops for which a white surface at `point` appears about as bright as in the studio: one that faces up,
/// or three quarters of the brightest one if that is more, so that neither the bed nor a wall in a low sun is
/// overexposed. Depends on environment, lights and bed alone: the same for any crop, size and print. 0 if there is no
/// light.
double automaticExposure(const SceneDescription& scene, const glm::dvec3& point);

}  // namespace stratum::shade
