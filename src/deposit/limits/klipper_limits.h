// The limits of a printer from Klipper's printer.cfg.
// Sources: klippy/toolhead.py, kinematics/*.py, kinematics/extruder.py and extras/gcode_arcs.py of August 2026:
// options, defaults and bounds; klippy/toolhead.py of March 2024 for max_accel_to_decel.
#pragma once

#include "gcode/machine/read_options.h"

#include <string>
#include <string_view>

namespace stratum::deposit {

/// Limits that the file leaves out are Klipper's defaults; without a section [extruder] those of moves of E alone are
/// assumed. [extruder1] and further ones are not read. Throws InputError with file and line.
gcode::PrinterLimits readKlipperLimits(const std::string& path, std::string_view text);

}  // namespace stratum::deposit
