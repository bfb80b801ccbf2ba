// Commands that lay no bead and change nothing this program follows, so that ignoring them deserves no remark.
#pragma once

#include <cstdint>

namespace stratum::gcode {

/// True for temperatures, fans, accelerations, levelling, displays, queries and the like; `letter` is 'G' or 'M'.
/// Sources: marlinfw.org/docs/gcode, reprap.org/wiki/G-code, docs.duet3d.com.
bool isHarmless(char letter, std::int32_t code);

}  // namespace stratum::gcode
