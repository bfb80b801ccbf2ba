// The least size of a pixel on objects: over a whole box, and by distance.
#pragma once

#include "shade/camera/camera.h"
#include "trace/intersector.h"

namespace stratum::shade {

/// The length, in world units, of a pixel's edge where a box is nearest to the camera: a lower bound for everything in
/// the box, anywhere in the frame. 0 if the eye is in the box. Measured across the viewing direction, at the depth of
/// that point; a lens is treated as a pinhole.
/// @param turns  number of pictures of a turntable: the least over all of them
double smallestPixel(const Camera& camera, const trace::Box& box, int turns = 1);

/// How that length grows with the distance from the eye.
struct PixelSpread {
    double smallest = 0;  ///< smallestPixel(), world units
    glm::dvec3 eye{0.0};  ///< world space
    double per_distance =
        0;  ///< at a distance d from the eye the size of a pixel is at least d times this, anywhere in the frame
    double farthest = 0;  ///< distance from the eye to the box's far end; 0 if there is more than one eye
};
PixelSpread pixelSpread(const Camera& camera, const trace::Box& box, int turns = 1);

}  // namespace stratum::shade
