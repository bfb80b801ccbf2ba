// The limits of a printer from commands: RepRapFirmware's config.g, or what Marlin answers to M503.
// Sources: RepRapFirmware 3.5's GCodes2.cpp and GCodes5.cpp (M92, M201, M203 with S1, M204, M205, M566) and its
// Configuration.h for defaults; marlinfw.org/docs/gcode/M503.html and reports of Marlin 1.0 to 2.1 that people posted.
#pragma once

#include "gcode/printer/read_options.h"

#include <optional>
#include <string>
#include <string_view>

namespace stratum::deposit {

/// Whose commands a text has; nothing if it has no limit of a machine in it.
/// Throws InputError for a program that prints.
std::optional<gcode::Firmware> firmwareOfCommands(const std::string& path, std::string_view text);

/// Limits that a config.g leaves out are RepRapFirmware's defaults; those that a report leaves out are not given. Of
/// several extruders the first counts. A report with junction deviation (M205 J) is by that rule; one with jerk by
/// Marlin 2's, or by Marlin 1's where its headings are none of Marlin 2's comments.
/// @param firmware  reprap or marlin
/// Throws InputError with file and line.
gcode::PrinterLimits readCommandLimits(const std::string& path, std::string_view text, gcode::Firmware firmware);

}  // namespace stratum::deposit
