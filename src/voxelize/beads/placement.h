// The transform from print space to a grid's world space.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/beads/lattice.h"

#include <openvdb/openvdb.h>

#include <array>
#include <string>

namespace stratum::voxelize {

/// From print space to the grid's world space: world = unit * (turned print + offset).
struct Placement {
    double unit = 1;               ///< world units a mm: 1 for mm, 0.1 for cm, 0.001 for m
    double offset[3] = {0, 0, 0};  ///< mm
    bool up_y = false;             ///< turn print z to world y: (x, y, z) becomes (x, z, -y)
    double tilt = 0;               ///< degrees about x that the print is turned by first: gcode::Toolpath::belt_angle
};

/// How a print lies in the world, mm: as the G-code has it, but turned on a belt.
Placement placementOf(const gcode::Toolpath& toolpath);

/// A place of print space, mm, in world space; and back.
std::array<double, 3> worldOf(const std::array<double, 3>& place, const Placement& placement);
std::array<double, 3> printOf(const std::array<double, 3>& world, const Placement& placement);

/// By the names of options. `unit`: see millimetresIn(); `up`: "z" or "y"; `origin`: "bed" as in the G-code, "center"
/// the box over the origin, "min" its corner there. `bounds` are of the print turned by `tilt`.
Placement placementOf(const std::string& unit, const std::string& up, const std::string& origin, const Bounds& bounds,
                      double tilt);

/// Millimetres in a world unit by its name in files and on command lines: mm, cm or m; 1 for unknown names.
double millimetresIn(const std::string& unit);

/// The transform of a grid on the lattice. Throws UsageError for voxels that are too small in world units.
openvdb::math::Transform::Ptr makeTransform(const Lattice& lattice, const Placement& placement);

}  // namespace stratum::voxelize
