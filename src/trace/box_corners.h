// The corners of an axis-aligned box.
#pragma once

#include "trace/intersector.h"

#include <glm/vec3.hpp>

#include <array>

namespace stratum::trace {

/// x changes fastest, then y.
inline std::array<glm::dvec3, 8> cornersOf(const Box& box) {
    std::array<glm::dvec3, 8> corners;
    for (unsigned n = 0; n < 8; ++n)
        corners[n] = {(n & 1u) != 0 ? box.max.x : box.min.x, (n & 2u) != 0 ? box.max.y : box.min.y,
                      (n & 4u) != 0 ? box.max.z : box.min.z};
    return corners;
}

}  // namespace stratum::trace
