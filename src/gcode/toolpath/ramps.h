// Ramps: beads that rise or fall within a layer that is level otherwise (scarf seams, the first turn of a spiral). They
// are as thick as their z above the layer below, not as the layer.
//
// A ramp ends or begins at the layer's z. Slicers scale its flow with its thickness, so that its width stays: where the
// widths that follow from that agree much better than those of the full height, it is a ramp; a spiral's later turns,
// which rise by a whole layer over the turn below, are none. Behind a scarf seam the wall ends above the ramp it began
// with, with as much flow as the gap between them needs. Sources: OrcaSlicer and PrusaSlicer, ExtrusionEntity and GCode
// ("scarf seam", "smooth spiral"), by their output.
#pragma once

#include "gcode/toolpath/toolpath.h"

namespace stratum::gcode {

/// Gives the beads of ramps, and those that close the gap above one, runs of their own height. The runs have their
/// final heights; `width` of the beads holds the section's area in mm^2. O(beads).
void splitRamps(Toolpath& toolpath);

}  // namespace stratum::gcode
