// Settings in a file's first and last comments: slicer, filament, layer height, mode and unit of E.
// Sources: the config blocks of PrusaSlicer, SuperSlicer, Slic3r, OrcaSlicer, BambuStudio ("; key = value"), the
// headers of Cura, Creality Print, ideaMaker, Simplify3D, Kiri:Moto, KISSlicer and Griffin files, Cura's profiles
// (cura.h), Skeinforge's "(<layerHeight> 0.3 )". Which color a preview shows: GCodeProcessor.cpp of PrusaSlicer
// (extruder_colour, filament_colour where that is empty), Plater.cpp of OrcaSlicer and BambuStudio (filament_colour).
#pragma once

#include "gcode/printer/machine_limits.h"
#include "gcode/slicer/extrusion_scan.h"
#include "gcode/slicer/footer.h"
#include "gcode/toolpath/color.h"
#include "gcode/toolpath/frame.h"
#include "gcode/toolpath/stated.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::gcode {

/// Values are absent if the file doesn't state them, or if they are invalid.
struct Settings {
    std::string slicer;                           ///< name and version
    std::vector<double> filament_diameters;       ///< mm, by tool
    std::optional<double> layer_height;           ///< mm
    std::optional<bool> relative_e;               ///< E words are increments
    std::optional<bool> volumetric_e;             ///< E words are mm^3
    std::string volumetric_reason;                ///< where the file states it
    std::vector<std::optional<Rgb>> tool_colors;  ///< by tool, as the slicer's own preview has it
    std::vector<Point> tool_offsets;        ///< mm by tool, which the slicer has subtracted; empty if all are zero
    std::optional<double> nozzle_diameter;  ///< mm, of the first tool
    std::optional<double> extrusion_width;  ///< mm
    ExtrusionScan extrusion;                ///< from the program's moves
    std::string cut_short;                  ///< why the program seems to end too early; empty if it doesn't
    bool shared_nozzle = false;             ///< several filaments share one nozzle
    Firmware firmware = Firmware::automatic;
    std::string firmware_reason;  ///< the file's statement about it
    SlicerLimits slicer_limits;   ///< Cura's by the machine's name or a profile; those of old PrusaSlicer
    std::string damaged_part;     ///< of the settings, in words, that couldn't be read; empty if there is none
    Footer footer;                ///< the filament that the file states
    StatedFacts stated;           ///< other statements about the print
};

/// "0x0,18x0": the nozzles' positions by tool, mm, as PrusaSlicer's extruder_offset has them. None for other text.
std::optional<std::vector<Point>> parseToolOffsets(std::string_view text);
/// The same for a user's text. Throws UsageError, which begins with `option`.
std::vector<Point> toolOffsetsOf(const std::string& text, const std::string& option);

/// Whether a slicer, by the name that it gives itself, estimates by CornerRule::bambu_jerk: OrcaSlicer and BambuStudio
/// from 2 on. Times of older ones, and of what is made of them, are nearer by slicer_jerk.
bool estimatesByVelocity(std::string_view slicer);

/// Reads the comments in the first and the last part of the bytes, scans the way of extruding, and checks for a
/// truncated end. Never throws for invalid contents.
Settings readSettings(std::string_view bytes);

}  // namespace stratum::gcode
