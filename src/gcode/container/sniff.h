// Rejects files that are not G-code, by content, never by name.
#pragma once

#include <string_view>

namespace stratum::gcode {

/// Without the zero bytes at the end that cards and printers leave there.
std::string_view withoutZeroTail(std::string_view bytes);

/// Throws InputError, with the kind of the bytes and the remedy, if they are empty, a container (inside another one),
/// a model, a picture, a file of another machine, or binary. Cheap: reads the beginning only. `bytes` has no zero tail,
/// unless it has nothing else.
void refuseOtherFormats(std::string_view bytes, std::string_view name);

}  // namespace stratum::gcode
