// The layer heights of beads that their slicer did not tag.
//
// A level run lies on the next lower level at which anything was extruded, or on the bed. Where the print is no plain
// stack (spirals, supports with layers of their own, objects one after another), what lies below each place decides
// instead (local_heights.h). Bridges without a tag are round threads, ironing is as thin as its own material.
// Sources: Slic3r's Flow (a bridge's thread is round); otherwise measured from the files themselves.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "gcode/toolpath/warning_log.h"

#include <optional>
#include <span>
#include <vector>

namespace stratum::gcode {

/// mm, by run, positive; a tagged height stays. `run_z[k]` is the z of level run k, NaN for a sloped one; the beads'
/// widths are areas in mm^2 still. Layers of spirals in files without a layer height are counted anew. Start-up lines
/// (layer 0) rest on the bed. `nominal` (mm) is 0.2 with a warning where it is needed and absent.
std::vector<double> findHeights(Toolpath& toolpath, std::span<const double> run_z, std::optional<double> nominal,
                                WarningLog& warnings);

}  // namespace stratum::gcode
