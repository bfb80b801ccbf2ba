// Commands that affect neither beads nor any simulated state: they are ignored without a warning.
#pragma once

#include <cstdint>
#include <string_view>

namespace stratum::gcode {

/// True for temperatures, fans, accelerations, levelling, displays, queries and the like; `letter` is 'G' or 'M'.
/// Sources: marlinfw.org/docs/gcode, reprap.org/wiki/G-code, docs.duet3d.com.
bool isHarmless(char letter, std::int32_t code);

/// The same for Klipper's named commands, whatever their case. Source: klipper3d.org/G-Codes.html.
bool isHarmlessMacro(std::string_view name);

}  // namespace stratum::gcode
