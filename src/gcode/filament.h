// Finds the filament diameter of a file that does not state it, from the file's own sums and from its sections.
// Sources: CuraEngine gcodeExport.cpp (Griffin headers state volumes, E is length); measured from files (filament.cpp).
#pragma once

#include "gcode/machine/machine.h"
#include "gcode/slicer/footer.h"
#include "gcode/toolpath/toolpath.h"
#include "gcode/toolpath/warning_log.h"

namespace stratum::gcode {

/// Fills filament_diameter, filament_mm, extruded_mm3, extrusion_rule and the footers. On entry the beads' widths are
/// areas in mm^2; they are scaled, with a warning, if the diameter is known only from the volume in a Griffin header.
void takeFilament(const Footer& footer, const Machine& machine, Toolpath& toolpath, WarningLog& warnings);

/// Warns of tools whose sections have a ratio to the first tool's like that of filaments of 1.75 and 2.85 mm: a slicer
/// with different diameters by tool writes such files, and --filament-diameter must state them. Widths are in mm.
void warnOfMixedFilaments(const Machine& machine, const Toolpath& toolpath, WarningLog& warnings);

}  // namespace stratum::gcode
