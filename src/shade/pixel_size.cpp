#include "shade/pixel_size.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace stratum::shade {
namespace {

double inOnePicture(const Camera& camera, const march::Box& box) {
    double depth = std::numeric_limits<double>::infinity();
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 p((corner & 1) != 0 ? box.max.x : box.min.x, (corner & 2) != 0 ? box.max.y : box.min.y,
                           (corner & 4) != 0 ? box.max.z : box.min.z);
        depth = std::min(depth, glm::dot(p - camera.eye(), camera.forward()));
    }
    const double slope = std::tan(camera.fov() * std::numbers::pi / 360.0);
    const double across = slope * camera.width() / camera.height();
    // What is beside or behind the camera isn't seen: within the frame, depth is at least the distance times the cosine
    // of the farthest corner.
    const double distance = glm::length(camera.eye() - glm::clamp(camera.eye(), box.min, box.max));
    depth = std::max(depth, distance / std::sqrt(1.0 + slope * slope + across * across));
    return depth * 2.0 * slope / camera.height();
}

}  // namespace

double smallestPixel(const Camera& camera, const march::Box& box, int turns) {
    const glm::dvec3 middle = 0.5 * (box.min + box.max);
    double smallest = inOnePicture(camera, box);
    for (int turn = 1; turn < turns; ++turn)
        smallest = std::min(smallest, inOnePicture(camera.turned(360.0 * turn / turns, middle), box));
    return smallest;
}

}  // namespace stratum::shade
