// The transform from print space to a grid's world space.
#pragma once

#include "voxelize/beads/bead_field.h"
#include "voxelize/beads/lattice.h"

#include <openvdb/openvdb.h>

#include <string>

namespace stratum::voxelize {

/// From print space to the grid's world space: world = unit * (print + offset).
struct Placement {
    double unit = 1;               ///< world units a mm: 1 for mm, 0.1 for cm, 0.001 for m
    double offset[3] = {0, 0, 0};  ///< mm
    bool up_y = false;             ///< turn print z to world y: (x, y, z) becomes (x, z, -y)
};

/// By the names of options. `unit`: see millimetresIn(); `up`: "z" or "y"; `origin`: "bed" as in the G-code, "center"
/// the box over the origin, "min" its corner there.
Placement placementOf(const std::string& unit, const std::string& up, const std::string& origin, const Bounds& bounds);

/// Millimetres in a world unit by its name in files and on command lines: mm, cm or m; 1 for unknown names.
double millimetresIn(const std::string& unit);

/// The transform of a grid on the lattice. Throws UsageError for voxels that are too small in world units.
openvdb::math::Transform::Ptr makeTransform(const Lattice& lattice, const Placement& placement);

}  // namespace stratum::voxelize
