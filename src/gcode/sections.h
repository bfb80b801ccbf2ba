// The second pass over a toolpath: from areas to heights and widths.
//
// The simulator knows each bead's cross-section area (from E) and, where the slicer tagged it, its height. What height
// an untagged bead has shows only when all z levels are known. Source of the section: Slic3r's Flow (stadium).
#pragma once

#include "gcode/toolpath.h"
#include "gcode/warning_log.h"

#include <optional>
#include <span>

namespace stratum::gcode {

/// `toolpath.beads[i].width` holds the section's area in mm^2 and becomes the width in mm. `toolpath.runs[k].height`
/// is the tagged height, or 0 to be found: for a level run (its z in `run_z[k]`) the distance to the next lower level
/// at which anything was extruded, or to the bed; for a sloped run (NaN) the nominal height. Beads of layer 0 rest on
/// the bed. `nominal_height` is 0.2 mm with a warning where it is needed and absent.
void resolveSections(Toolpath& toolpath, std::span<const double> run_z, std::optional<double> nominal_height,
                     WarningLog& warnings);

}  // namespace stratum::gcode
