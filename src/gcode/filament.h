// Finds the filament diameter of a file that does not state it, from the file's own sums and from its sections.
// Sources: CuraEngine gcodeExport.cpp (Griffin headers state volumes, E is length); measured from files (filament.cpp):
// of 111 public prints whose filament is known, the median of area / height as if of 1.75 mm was 0.07 to 0.20 mm where
// it was 2.85 mm, and 0.34 mm or more where it was 1.75 mm.
#pragma once

#include "gcode/machine/machine.h"
#include "gcode/slicer/footer.h"
#include "gcode/toolpath/toolpath.h"
#include "gcode/toolpath/warning_log.h"

#include <optional>

namespace stratum::gcode {

/// Fills filament_diameter, filament_mm, prime_mm, flushed_mm, extruded_mm3, extrusion_rule and the footers.
/// On entry the beads' widths are areas in mm^2; they are scaled, with a warning, if the diameter is known only from
/// the volume in a Griffin header. True if the diameter is known.
bool takeFilament(const Footer& footer, const Machine& machine, Toolpath& toolpath, WarningLog& warnings);

/// For a toolpath whose diameter is not known: tells 2.85 mm from 1.75 mm by the median of area / height, the width of
/// the lines, and scales the areas, with a warning. Warns where the median is between the two, or the print is too
/// small to tell. Widths are areas in mm^2, heights are known.
/// @param nozzle  diameter in mm, if the file states it
void chooseFilament(std::optional<double> nozzle, Toolpath& toolpath, WarningLog& warnings);

/// Warns of tools whose sections have a ratio to the first tool's like that of filaments of 1.75 and 2.85 mm: a slicer
/// with different diameters by tool writes such files, and --filament-diameter must state them. Widths are in mm.
void warnOfMixedFilaments(const Machine& machine, const Toolpath& toolpath, WarningLog& warnings);

}  // namespace stratum::gcode
