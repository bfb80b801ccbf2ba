// Rejects files that are not G-code, by content, never by name.
#pragma once

#include <string_view>

namespace stratum::gcode {

/// Throws InputError, with the kind of the bytes and the remedy, if they are empty, a container (inside another one),
/// an STL model, or binary. Cheap: reads the beginning only.
void refuseOtherFormats(std::string_view bytes, std::string_view name);

}  // namespace stratum::gcode
