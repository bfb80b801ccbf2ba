// What a file says about itself in its first and last comments: slicer, filament, layer height, how E counts.
// Sources: the config blocks of PrusaSlicer, SuperSlicer, Slic3r ("; key = value"), the headers of Cura, ideaMaker,
// Simplify3D, Kiri:Moto and Griffin files.
#pragma once

#include "gcode/reader.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::gcode {

/// Values are absent where the file is silent or says nonsense.
struct Settings {
    std::string slicer;                      ///< name and version
    std::vector<double> filament_diameters;  ///< mm, by tool
    std::optional<double> layer_height;      ///< mm
    std::optional<bool> relative_e;          ///< E words are increments
    std::optional<bool> volumetric_e;        ///< E words are mm^3
    bool shared_nozzle = false;              ///< several filaments take turns in one nozzle
    Firmware firmware = Firmware::automatic;
};

/// Reads the comments in the first and the last part of the bytes. Never throws for what it finds there.
Settings readSettings(std::string_view bytes);

}  // namespace stratum::gcode
