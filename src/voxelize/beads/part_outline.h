// Points around the printed part, closer than its box: for cameras.
#pragma once

#include "gcode/toolpath/purpose.h"
#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/bead_field.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace stratum::voxelize {

/// Points, mm, whose convex hull holds the part: the corners of polygons around its slabs. The polygons are 0.5 % too
/// large at most, for a part of round slabs. A few thousand points for any number of beads. Single-threaded.
/// @param purposes   gcode::purposesOf() of the toolpath
/// @param selection  indices into `toolpath.beads`, at least one
/// @param bounds     partBounds() of the same beads; what lies beyond, of a brim, is left out
std::vector<std::array<double, 3>> partOutline(const gcode::Toolpath& toolpath,
                                               std::span<const gcode::Purpose> purposes,
                                               std::span<const std::uint32_t> selection, const Bounds& bounds);

}  // namespace stratum::voxelize
