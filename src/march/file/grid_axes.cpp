#include "march/file/grid_axes.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace stratum::march {

GridAxes::GridAxes(const openvdb::math::Transform& transform) : edges(0.0) {
    const auto map = transform.baseMap();
    for (int axis = 0; axis < 3; ++axis) {
        openvdb::Vec3d unit(0, 0, 0);
        unit[axis] = 1;
        const openvdb::Vec3d edge = map->applyJacobian(unit);
        edges[axis] = {edge[0], edge[1], edge[2]};
    }
}

double GridAxes::shortest() const {
    return std::min({glm::length(edges[0]), glm::length(edges[1]), glm::length(edges[2])});
}

double GridAxes::longest() const {
    return std::max({glm::length(edges[0]), glm::length(edges[1]), glm::length(edges[2])});
}

double GridAxes::shear() const {
    const glm::dvec3 x = glm::normalize(edges[0]);
    const glm::dvec3 y = glm::normalize(edges[1]);
    const glm::dvec3 z = glm::normalize(edges[2]);
    return std::max({std::abs(glm::dot(x, y)), std::abs(glm::dot(y, z)), std::abs(glm::dot(z, x))});
}

}  // namespace stratum::march
