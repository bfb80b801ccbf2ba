// Tells G-code from what is given by mistake, by content, never by name.
#pragma once

#include <string_view>

namespace stratum::gcode {

/// Throws InputError, naming what the bytes are and what to do, if they are empty, a container (after one was
/// opened already), a STL model, or binary. Cheap: looks at the beginning only.
void refuseOtherFormats(std::string_view bytes, std::string_view name);

}  // namespace stratum::gcode
