// The transform from print space to a grid's world space.
#pragma once

#include "voxelize/beads/lattice.h"

#include <openvdb/openvdb.h>

namespace stratum::voxelize {

/// From print space to the grid's world space: world = unit * (print + offset).
struct Placement {
    double unit = 1;               ///< world units a mm: 1 for mm, 0.1 for cm, 0.001 for m
    double offset[3] = {0, 0, 0};  ///< mm
    bool up_y = false;             ///< turn print z to world y: (x, y, z) becomes (x, z, -y)
};

/// The transform of a grid on the lattice. Throws UsageError for voxels that are too small in world units.
openvdb::math::Transform::Ptr makeTransform(const Lattice& lattice, const Placement& placement);

}  // namespace stratum::voxelize
