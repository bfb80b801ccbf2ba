// Bounds of the printed part without skirts, towers and start lines.
#pragma once

#include "gcode/toolpath/purpose.h"
#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/beads/placement.h"

#include <cstdint>
#include <span>

namespace stratum::voxelize {

/// A brim counts as part of the box up to this distance from it, mm.
inline constexpr double kBrimReach = 10;

/// Bounds of the selected beads, mm, without what is printed beside the part (gcode::Purpose); supports count, a brim
/// only within kBrimReach. If nothing else is selected: bounds of all selected beads. Of the print turned by `tilt`
/// degrees about x.
/// @param purposes   gcode::purposesOf() of the toolpath
/// @param selection  indices into `toolpath.beads`, at least one
Bounds partBounds(const gcode::Toolpath& toolpath, std::span<const gcode::Purpose> purposes,
                  std::span<const std::uint32_t> selection, double tilt = 0);

/// The same box, which is that of the print turned by placement.tilt, after a placement, world units.
Bounds placed(const Bounds& bounds, const Placement& placement);

}  // namespace stratum::voxelize
