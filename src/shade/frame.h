// The local frame of a surface point: z is the normal.
//
// Source: T. Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1) 2017. There the basis flips where
// normal.z changes its sign. Walls of prints are vertical, and the last bit of their normals is rounding, which would
// decide where rays go; so here it flips at another z, which only overhangs have.
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <cmath>

namespace stratum::shade {

struct Frame {
    /// The basis is another one where normal.z is below. Not near -1, where 1 + z cancels.
    static constexpr float kFlipZ = -0.55f;

    glm::vec3 x, y, z;  ///< orthonormal, right-handed

    /// @param normal  unit
    explicit Frame(const glm::vec3& normal) : z(normal) {
        const float sign = normal.z < kFlipZ ? -1.0f : 1.0f;
        const float a = -1.0f / (sign + normal.z);
        const float b = normal.x * normal.y * a;
        x = glm::vec3(1.0f + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
        y = glm::vec3(b, sign + normal.y * normal.y * a, -normal.y);
    }

    /// With x along the part of `grain` that lies in the plane; any basis if there is none.
    Frame(const glm::vec3& normal, const glm::vec3& grain) : Frame(normal) {
        const glm::vec3 tangent = grain - glm::dot(grain, normal) * normal;
        const float length2 = glm::dot(tangent, tangent);
        // Below, rounding of the difference would decide the direction.
        constexpr float kLeast2 = 1e-8f;
        if (!(length2 > kLeast2)) return;
        x = tangent / std::sqrt(length2);
        y = glm::cross(z, x);
    }

    glm::vec3 toLocal(const glm::vec3& v) const { return {glm::dot(v, x), glm::dot(v, y), glm::dot(v, z)}; }
    glm::vec3 toWorld(const glm::vec3& v) const { return v.x * x + v.y * y + v.z * z; }
};

}  // namespace stratum::shade
