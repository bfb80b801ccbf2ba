// Points around the printed part, closer than its box: for cameras, and as metadata of level sets.
#pragma once

#include "gcode/toolpath/purpose.h"
#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/beads/placement.h"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace stratum::voxelize {

// Bounds of the printed part without skirts, towers and start lines.

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

/// Points, mm, whose convex hull is that of the part within 0.5 % of its size: corners of polygons around its slabs,
/// those that are farthest in one of kOutlineDirections. Some hundred points for any number of beads. Single-threaded.
/// @param purposes   gcode::purposesOf() of the toolpath
/// @param selection  indices into `toolpath.beads`, at least one
/// @param bounds     partBounds() of the same beads; what lies beyond, of a brim, is left out
inline constexpr std::size_t kOutlineDirections = 1024;
std::vector<std::array<double, 3>> partOutline(const gcode::Toolpath& toolpath,
                                               std::span<const gcode::Purpose> purposes,
                                               std::span<const std::uint32_t> selection, const Bounds& bounds);

/// The same points after a placement, world units; of a tilted one in floats, as in files.
std::vector<std::array<double, 3>> placed(std::vector<std::array<double, 3>> outline, const Placement& placement);

/// Points as text, "x y z x y z ...", for metadata; and back. No points for text that is anything else, is not finite,
/// or is longer than any that gcode2vdb writes.
std::string textOf(std::span<const std::array<double, 3>> outline);
std::vector<std::array<double, 3>> outlineFromText(const std::string& text);

}  // namespace stratum::voxelize
