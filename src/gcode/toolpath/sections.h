// The second pass over a toolpath: computes heights and widths from areas.
//
// The simulator has each bead's cross-section area (from E) and, if the slicer tagged it, its height. The height of an
// untagged bead can be found only when all z levels are known. Source of the section: Slic3r's Flow (stadium).
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "gcode/toolpath/warning_log.h"

#include <optional>
#include <span>

namespace stratum::gcode {

/// Finds the heights of runs that no tag has set. Those that are set stay.
void resolveHeights(Toolpath& toolpath, std::span<const double> run_z, std::optional<double> nominal_height,
                    WarningLog& warnings);

/// `toolpath.beads[i].width` holds the section's area in mm^2 and becomes the width in mm. `toolpath.runs[k].height` is
/// the tagged height, or 0 if findHeights() must find it; `run_z` and `nominal_height` are its parameters. Warns of the
/// last layer if the program is truncated.
void resolveSections(Toolpath& toolpath, std::span<const double> run_z, std::optional<double> nominal_height,
                     WarningLog& warnings);

}  // namespace stratum::gcode
