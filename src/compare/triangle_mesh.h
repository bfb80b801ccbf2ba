// A polygon model: what a print was meant to be.
#pragma once

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace stratum::compare {

using Triangle = std::array<std::uint32_t, 3>;

/// Points in mm. Corners of a triangle run counter-clockwise seen from outside.
struct TriangleMesh {
    std::vector<glm::dvec3> points;
    std::vector<Triangle> triangles;

    glm::dvec3 corner(const Triangle& triangle, std::size_t n) const { return points[triangle[n]]; }
    /// Twice the area, along the normal.
    glm::dvec3 areaNormal(const Triangle& triangle) const;
};

}  // namespace stratum::compare
