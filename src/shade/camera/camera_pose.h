// Camera pose of a photograph, from points with known pixels and world positions.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <span>

namespace stratum::shade {

/// A point in the photograph and in the scene.
struct PointPair {
    glm::dvec2 pixel{0.0};  ///< from the upper left corner, y down
    glm::dvec3 point{0.0};  ///< world space
};

struct CameraPose {
    glm::dvec3 eye{0.0};                ///< world space
    glm::dvec3 forward{0.0, 1.0, 0.0};  ///< unit, into the picture
    glm::dvec3 up{0.0, 0.0, 1.0};       ///< unit, up in the picture
    double fov = 0.0;                   ///< degrees, vertical, whole angle
    double rms_pixels = 0.0;            ///< root mean square of the reprojection errors
    double worst_pixels = 0.0;          ///< the largest of them
    std::size_t worst = 0;              ///< the pair that has it, from 0
};

/// Finds the pose and focal length of a pinhole with square pixels whose axis meets the middle of the picture: by the
/// direct linear transform, then by Levenberg and Marquardt's steps on the squared distances in pixels. At least six
/// pairs, whose points don't lie in a plane.
/// @param width, height  of the photograph, pixels
/// Throws InputError: too few pairs, no numbers, points in (or almost in) a plane or a line or all the same, pairs that
/// only a mirrored picture could have.
/// Sources: R. Hartley, A. Zisserman, "Multiple View Geometry" (2004), 7.1 and A6.
CameraPose solveCameraPose(std::span<const PointPair> pairs, double width, double height);

}  // namespace stratum::shade
