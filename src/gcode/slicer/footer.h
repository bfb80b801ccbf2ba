// The filament that a file states: the slicer's sums in its header or trailer, for comparison with the toolpath.
// Sources: PrusaSlicer and its kin ("filament used [mm] = 1.5, 2"), BambuStudio ("total filament length [mm] : 1.5,2"),
// Slic3r ("filament used = 290.4mm", "filament_length_m = 0.2904"), KISSlicer ("Ext 1 = 53.49 mm"), Cura ("Filament
// used: 0.27387m, 0m", or in mm3 where its E is), Griffin headers ("EXTRUDER_TRAIN.0.MATERIAL.VOLUME_USED:12034"),
// Simplify3D ("Filament length: 2706.2 mm"), ideaMaker ("Material#1 Used: 422.7", which is what E says times "Filament
// Compensation #1: 94.00" per cent), Kiri:Moto ("--- filament used: 225").
#pragma once

#include <string_view>
#include <vector>

namespace stratum::gcode {

/// By tool; a list of one is the sum of all tools. At most one of the two is filled.
struct Footer {
    std::vector<double> length;  ///< mm of filament
    std::vector<double> volume;  ///< mm^3
    std::vector<double> flow;    ///< by tool: what lengths are multiplied by beside E; 0 or short: nothing

    bool a_line_each = false;  ///< the last statement was of one tool, and the next one is of the next

    bool empty() const { return length.empty() && volume.empty(); }
};

/// Parses a comment (without its ';', trimmed) if it is such a statement; the last one counts. False if it is none.
bool readFooter(std::string_view comment, Footer& footer);

}  // namespace stratum::gcode
