// Arrays -> Toolpath, checked.
#pragma once

#include "gcode/toolpath/toolpath.h"

namespace stratum::python {

/// Throws UsageError, with the array, the index, what was expected and the remedy, unless every record is one that
/// everything after the reader can work with: finite coordinates in range, widths and heights above zero, indices
/// that exist. Needs no GIL.
void requireValid(const gcode::Toolpath& toolpath);

/// Fills in what follows from the beads of a toolpath that no file states: layers, filament, volume.
/// @param before  what it was made from, whose tools may have filaments of several diameters; null: nothing
void sumUp(gcode::Toolpath& toolpath, const gcode::Toolpath* before);

}  // namespace stratum::python
