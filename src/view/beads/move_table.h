// What a program does besides beads, for a page that draws it: travels as lines, and marks at places.
#pragma once

#include "gcode/reader.h"
#include "gcode/toolpath/toolpath.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace stratum::view {

enum class MoveKind : std::uint8_t {
    travel,      ///< without plastic
    wipe,        ///< filament is drawn back on the way
    retraction,  ///< of filament, at rest
    recovery,    ///< it comes forward again
    seam,        ///< where a line of external perimeter begins
    tool_change,
    pause,
    filament_change,
    count_
};

/// A record of 32 bytes, as the page gets it.
struct MoveRecord {
    float x0 = 0, y0 = 0, z0 = 0;  ///< mm, of the nozzle
    float x1 = 0, y1 = 0, z1 = 0;  ///< of marks the same
    std::uint32_t bead = 0;        ///< the number of beads that are laid before it
    std::uint32_t line = 0;        ///< of the program | kind << 28 | 1 << 31 if it goes on with the one before it
};
static_assert(sizeof(MoveRecord) == 32);

/// Reads the program once more. Arcs without plastic become several records, of which one counts.
/// @param shown  what was read of it before
/// Throws InputError, with the reason, if it can't be read, has changed, or does not fit.
std::vector<MoveRecord> movesOf(std::string_view bytes, std::string_view name, gcode::ReadOptions options,
                                const gcode::Toolpath& shown);

}  // namespace stratum::view
