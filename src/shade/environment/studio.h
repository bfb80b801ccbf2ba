// A photographer's studio: softboxes in a dim room, arranged about the camera so that layer lines can be read.
#pragma once

#include "shade/environment/environment.h"

#include <memory>

namespace stratum::shade {

/// Radiance of a white Lambert surface that looks up, with nothing in its way. Bright enough that a print and the paper
/// under it need no exposure.
inline constexpr float kStudioLevel = 1.5f;

/// A key light high on the left, a broad weak fill on the right, two strips behind that draw the rims, and a room that
/// is brighter above than at the horizon. Edges are smooth. Tabulated as a map, so that it is drawn from like one; not
/// visible to the camera.
std::shared_ptr<const Environment> makeStudio(const EnvironmentPlacement& placement);

}  // namespace stratum::shade
