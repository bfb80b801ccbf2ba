// How much of a thing one pixel shows, at least.
#pragma once

#include "march/intersector.h"
#include "shade/camera.h"

namespace stratum::shade {

/// The length, in world units, that a pixel's edge spans where a box is nearest to the camera: no part of what lies in
/// the box is seen larger, wherever in the frame it is. 0 if the eye is in the box. A length across the line of sight,
/// on the plane at the depth of that place; a lens is taken for a pinhole.
/// @param turns  for a turntable of so many pictures, in any of them
double smallestPixel(const Camera& camera, const march::Box& box, int turns = 1);

}  // namespace stratum::shade
