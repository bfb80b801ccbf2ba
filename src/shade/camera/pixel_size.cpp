#include "shade/camera/pixel_size.h"

#include "trace/box_corners.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace stratum::shade {
namespace {

// Cosine between the ray to a corner of the frame and the viewing direction: the least of all rays.
double leastCosine(const Camera& camera) {
    const double slope = std::tan(camera.fov() * std::numbers::pi / 360.0);
    const double across = slope * camera.width() / camera.height();
    return 1.0 / std::sqrt(1.0 + slope * slope + across * across);
}

double inOnePicture(const Camera& camera, const trace::Box& box) {
    double depth = std::numeric_limits<double>::infinity();
    for (const glm::dvec3& corner : trace::cornersOf(box))
        depth = std::min(depth, glm::dot(corner - camera.eye(), camera.forward()));
    // Within the frame, depth is at least the distance times the cosine of the farthest corner; points beside or behind
    // the camera are invisible.
    const double distance = glm::length(camera.eye() - glm::clamp(camera.eye(), box.min, box.max));
    return std::max(depth, distance * leastCosine(camera)) * camera.pixelSize();
}

}  // namespace

double smallestPixel(const Camera& camera, const trace::Box& box, int turns) {
    const glm::dvec3 middle = 0.5 * (box.min + box.max);
    double smallest = inOnePicture(camera, box);
    for (int turn = 1; turn < turns; ++turn)
        smallest = std::min(smallest, inOnePicture(camera.turned(360.0 * turn / turns, middle), box));
    return smallest;
}

PixelSpread pixelSpread(const Camera& camera, const trace::Box& box, int turns) {
    PixelSpread spread;
    spread.smallest = smallestPixel(camera, box, turns);
    spread.eye = camera.eye();
    spread.per_distance = leastCosine(camera) * camera.pixelSize();
    if (turns <= 1)
        spread.farthest = glm::length(glm::max(glm::abs(box.min - camera.eye()), glm::abs(box.max - camera.eye())));
    return spread;
}

}  // namespace stratum::shade
