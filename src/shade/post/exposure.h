// How bright a picture is to be shown, found from its light.
#pragma once

#include "shade/scene/scene.h"

#include <glm/vec3.hpp>

namespace stratum::shade {

/// Stops by which light must be scaled (2^stops) so that a white surface at `point` is shown about as bright as under
/// the studio: one that looks up, or three quarters of the one that gets most, if that is more, so that neither the bed
/// nor a wall in a low sun is burnt. From environment, lamps and bed alone: the same for any crop, size and print.
/// 0 where there is no light.
double automaticExposure(const SceneDescription& scene, const glm::dvec3& point);

}  // namespace stratum::shade
