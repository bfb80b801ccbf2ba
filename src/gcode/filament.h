// Which filament E counts, where the file does not say: what its own sums and sections tell.
// Sources: CuraEngine gcodeExport.cpp (Griffin headers state volumes, E is length); measured from files (filament.cpp).
#pragma once

#include "gcode/machine/machine.h"
#include "gcode/slicer/footer.h"
#include "gcode/toolpath/toolpath.h"
#include "gcode/toolpath/warning_log.h"

namespace stratum::gcode {

/// Fills filament_diameter, filament_mm, extruded_mm3, extrusion_rule and the footers. Beads' widths are areas in mm^2
/// still; they are scaled, with a warning, where the volume in a Griffin header tells the diameter that nothing else
/// does.
void takeFilament(const Footer& footer, const Machine& machine, Toolpath& toolpath, WarningLog& warnings);

/// Warns of tools whose sections stand to the first tool's as filaments of 1.75 and 2.85 mm do: a slicer that was told
/// different diameters writes so, and only --filament-diameter can say it. Widths are widths.
void warnOfMixedFilaments(const Machine& machine, const Toolpath& toolpath, WarningLog& warnings);

}  // namespace stratum::gcode
