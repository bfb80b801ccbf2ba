// The second pass over a toolpath: from areas to heights and widths.
//
// The simulator knows each bead's cross-section area (from E) and, where the slicer tagged it, its height. What height
// an untagged bead has shows only when all z levels are known. Source of the section: Slic3r's Flow (stadium).
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "gcode/toolpath/warning_log.h"

#include <optional>
#include <span>

namespace stratum::gcode {

/// `toolpath.beads[i].width` holds the section's area in mm^2 and becomes the width in mm. `toolpath.runs[k].height` is
/// the tagged height, or 0 to be found by findHeights(), which says what `run_z` and `nominal_height` mean. Says in a
/// warning which layer is the last where the program was cut short.
void resolveSections(Toolpath& toolpath, std::span<const double> run_z, std::optional<double> nominal_height,
                     WarningLog& warnings);

}  // namespace stratum::gcode
