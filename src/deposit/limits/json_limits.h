// The limits of a printer in the project's own JSON.
#pragma once

#include "base/options/json_section.h"
#include "gcode/printer/read_options.h"

#include <string_view>

namespace stratum::deposit {

/// @param section  the object "limits"; docs/printers.md has its keys
/// @param bytes    the whole file, for the lines of the keys
/// Throws InputError for unknown keys and impossible values, with their place.
gcode::PrinterLimits readJsonLimits(JsonSection section, std::string_view bytes);

}  // namespace stratum::deposit
