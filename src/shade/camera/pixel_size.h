// How much of a thing one pixel shows, at least: over a whole box, and by distance.
#pragma once

#include "shade/camera/camera.h"
#include "trace/intersector.h"

namespace stratum::shade {

/// The length, in world units, that a pixel's edge spans where a box is nearest to the camera: no part of what lies in
/// the box is seen larger, wherever in the frame it is. 0 if the eye is in the box. A length across the line of sight,
/// on the plane at the depth of that place; a lens is taken for a pinhole.
/// @param turns  for a turntable of so many pictures, in any of them
double smallestPixel(const Camera& camera, const trace::Box& box, int turns = 1);

/// How that length grows with the distance from the eye.
struct PixelSpread {
    double smallest = 0;  ///< smallestPixel(), world units
    glm::dvec3 eye{0.0};  ///< world space
    double per_distance =
        0;                ///< at a distance d from the eye a pixel spans d times that or more, wherever in the frame
    double farthest = 0;  ///< distance from the eye to the box's far end; 0 if there is more than one eye
};
PixelSpread pixelSpread(const Camera& camera, const trace::Box& box, int turns = 1);

}  // namespace stratum::shade
