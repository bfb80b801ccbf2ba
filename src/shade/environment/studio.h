// Studio light: softboxes in a dim room, arranged around the camera so that layer lines are visible.
#pragma once

#include "shade/environment/environment.h"

#include <memory>

namespace stratum::shade {

/// Radiance of an unoccluded white Lambert surface that faces up. Bright enough for a print and the paper under it
/// without exposure compensation.
inline constexpr float kStudioLevel = 1.5f;

/// A key light high on the left, a broad weak fill light on the right, two rim lights behind, and a room that is
/// brighter above than at the horizon. Edges are smooth. Tabulated and sampled as a map; not visible to the camera.
std::shared_ptr<const Environment> makeStudio(const EnvironmentPlacement& placement);

}  // namespace stratum::shade
