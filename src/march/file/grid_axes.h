// The edges of a grid's voxels in world space.
#pragma once

#include <openvdb/openvdb.h>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace stratum::march {

/// The three edges of a voxel, as columns, in world units. The transform must be linear.
struct GridAxes {
    explicit GridAxes(const openvdb::math::Transform& transform);

    /// Edge lengths, world units.
    double shortest() const;
    double longest() const;
    /// The largest |cosine| between two edges: 0 for boxes, rounding included about 1e-16; more is shear. No number if
    /// an edge has no length.
    double shear() const;

    glm::dmat3 edges;
};

}  // namespace stratum::march
