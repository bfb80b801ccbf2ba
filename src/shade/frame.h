// The local frame of a surface point: z is the normal.
//
// Source: T. Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1) 2017.
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <cmath>

namespace stratum::shade {

struct Frame {
    glm::vec3 x, y, z;  ///< orthonormal, right-handed

    /// @param normal  unit
    explicit Frame(const glm::vec3& normal) : z(normal) {
        const float sign = std::copysign(1.0f, normal.z);
        const float a = -1.0f / (sign + normal.z);
        const float b = normal.x * normal.y * a;
        x = glm::vec3(1.0f + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
        y = glm::vec3(b, sign + normal.y * normal.y * a, -normal.y);
    }

    glm::vec3 toLocal(const glm::vec3& v) const { return {glm::dot(v, x), glm::dot(v, y), glm::dot(v, z)}; }
    glm::vec3 toWorld(const glm::vec3& v) const { return v.x * x + v.y * y + v.z * z; }
};

}  // namespace stratum::shade
