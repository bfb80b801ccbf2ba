// The moves of a program on their way to a page that has asked for them.
#pragma once

#include "gcode/reader.h"
#include "gcode/toolpath/toolpath.h"
#include "view/input/document.h"
#include "view/input/output.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace stratum::view {

// What a program does besides beads, for a page that draws it: travels as lines, and marks at places.

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

/// For one page and one thread. Messages: "moves" with the number of records, then "move-part" with records, or
/// "no-moves" with the reason.
class MoveStream {
public:
    MoveStream(Document& document, const Output& output) : document_(document), output_(output) {}

    /// Sends the next part of what the document holds now. Returns whether there is more.
    bool sendPart();

private:
    Document& document_;
    const Output& output_;
    std::optional<std::vector<MoveRecord>> records_;
    std::uint64_t generation_ = 0;  // of the records
    std::size_t next_ = 0;          // record
};

}  // namespace stratum::view
