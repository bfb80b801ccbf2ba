// Where the part stands among all that is printed with it.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/beads/placement.h"

#include <cstdint>
#include <span>

namespace stratum::voxelize {

/// How far a brim may reach beyond the part's box and still belong to it, mm.
inline constexpr double kBrimReach = 10;

/// Bounds of the selected beads, mm, without what is printed beside the part: skirts, prime towers and custom G-code
/// (start lines); of a brim only what lies within kBrimReach. If nothing else is selected: of all.
/// @param selection  indices into `toolpath.beads`, at least one
Bounds partBounds(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection);

/// The same box where a placement puts it, world units.
Bounds placed(const Bounds& bounds, const Placement& placement);

}  // namespace stratum::voxelize
