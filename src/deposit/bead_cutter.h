// Cuts beads into pieces with widths and heights of their own: what flow and sag do to a toolpath.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <cstdint>
#include <span>

namespace stratum::deposit {

/// A part of a bead's path. A piece of no length is a disc at that place.
struct BeadPiece {
    std::uint32_t bead = 0;      ///< index into Toolpath::beads
    double from = 0, to = 1;     ///< fractions of the path's length in the plane
    float width = 0;             ///< mm, the mean
    gcode::BeadFlow flow{};      ///< kept if Toolpath::flow is not empty
    gcode::BeadTiming timing{};  ///< kept if Toolpath::timing is not empty
    double drop0 = 0;            ///< mm, how far the start lies below the path
    double drop1 = 0;            ///< mm, of the end
};

/// Replaces all beads by these pieces, which are in print order. Pieces of an arc are arcs. Lines of the source, runs
/// and changes of color stay with their beads; a bead without a piece is gone.
void cutBeads(gcode::Toolpath& toolpath, std::span<const BeadPiece> pieces);

}  // namespace stratum::deposit
