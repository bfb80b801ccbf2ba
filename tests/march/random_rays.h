// Rays of every kind that a scene sends, and of the kinds that it should not.
#pragma once

#include "trace/intersector.h"

#include <glm/geometric.hpp>

#include <cstdint>
#include <random>
#include <vector>

namespace stratum::test {

inline glm::dvec3 randomDirection(std::mt19937& random) {
    std::normal_distribution<double> normal;
    return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
}

/// Within +-reach of the origin and from five times as far; some with limits. A share of them runs along axes and
/// planes of a lattice of `voxel`, with zero and tiny components.
inline std::vector<trace::Ray> randomRays(std::size_t count, double reach, double voxel, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> where(-reach, reach);
    std::vector<trace::Ray> rays(count);
    for (std::size_t n = 0; n < count; ++n) {
        trace::Ray& ray = rays[n];
        ray.origin =
            n % 3 == 0 ? glm::dvec3(where(random), where(random), where(random)) : 5 * reach * randomDirection(random);
        ray.direction = glm::normalize(glm::dvec3(where(random), where(random), where(random)) - ray.origin);
        if (n % 7 == 0) ray.t_min = 0.5 * glm::length(ray.origin);
        if (n % 11 == 0) ray.t_max = glm::length(ray.origin);
        if (n % 5 != 0) continue;
        const auto axis = static_cast<glm::length_t>(n % 3);
        ray.origin = voxel * glm::round(ray.origin / voxel);
        ray.direction = glm::dvec3(0.0);
        ray.direction[axis] = ray.origin[axis] > 0 ? -1 : 1;
        if (n % 2 == 0) ray.direction[(axis + 1) % 3] = n % 4 == 0 ? 1e-7 : -0.0;
        if (n % 15 == 0) ray.direction[(axis + 2) % 3] = n % 10 == 0 ? 1 : -1e-310;
        ray.direction = glm::normalize(ray.direction);
        if (n % 25 == 0) ray.origin -= 1e6 * ray.direction;
    }
    return rays;
}

}  // namespace stratum::test
