#include "compare/triangle_mesh.h"

#include <glm/geometric.hpp>

namespace stratum::compare {

glm::dvec3 TriangleMesh::areaNormal(const Triangle& triangle) const {
    const glm::dvec3 a = corner(triangle, 0);
    return glm::cross(corner(triangle, 1) - a, corner(triangle, 2) - a);
}

}  // namespace stratum::compare
