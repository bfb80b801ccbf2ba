// Finds the layer heights of beads without a height tag.
//
// A level run rests on the next lower level with extrusion, or on the bed. Where the print is not a plain stack of
// layers (spirals, supports with layers of their own, objects one after another), the material below each position is
// used instead (local_heights.h). Bridges without a tag are round threads; the height of ironing follows from its area.
// Sources: Slic3r's Flow (a bridge's thread is round); otherwise measured from the files themselves.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "gcode/toolpath/warning_log.h"

#include <optional>
#include <span>
#include <vector>

namespace stratum::gcode {

/// mm, by run, positive; tagged heights don't change. `run_z[k]` is the z of level run k, NaN for a sloped one; the
/// beads' widths are areas in mm^2. Layers of spirals in files without a layer height are recounted. Prime lines
/// (layer 0) rest on the bed. `nominal` (mm) defaults to 0.2, with a warning if it is needed.
std::vector<double> findHeights(Toolpath& toolpath, std::span<const double> run_z, std::optional<double> nominal,
                                WarningLog& warnings);

}  // namespace stratum::gcode
