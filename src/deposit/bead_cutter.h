// Cuts beads into pieces with widths and heights of their own: what flow and sag do to a toolpath.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace stratum::deposit {

/// Both ends of a piece, mm, as Bead has them.
struct PiecePlace {
    double x0, y0, z0, x1, y1, z1;
};

/// A part of a bead's path. A piece of no length is a disc at that place.
struct BeadPiece {
    std::uint32_t bead = 0;      ///< index into Toolpath::beads
    double from = 0, to = 1;     ///< fractions of the path's length in the plane
    float width = 0;             ///< mm, the mean
    gcode::BeadFlow flow{};      ///< kept if the cutter was told to
    gcode::BeadTiming timing{};  ///< kept if Toolpath::timing is not empty
    double drop0 = 0;            ///< mm, how far the start lies below the path
    double drop1 = 0;            ///< mm, of the end
    /// Not on the bead's path but here, straight: a string, which has the bead's height, tool and line.
    std::optional<PiecePlace> apart{};
};

/// All of a bead, as it is.
BeadPiece wholeBead(const gcode::Toolpath& toolpath, std::uint32_t bead);

/// Replaces all beads of a toolpath by pieces. They are made while the toolpath is still as it was, one after the
/// other, for a whole print of them beside both toolpaths would cost more time than the cutting.
class BeadCutter {
public:
    /// `with_flow`: pieces have it, and Toolpath::flow will. `expected`: about how many pieces there will be.
    BeadCutter(gcode::Toolpath& toolpath, bool with_flow, std::size_t expected);

    /// The next piece, in print order.
    void add(const BeadPiece& piece);

    /// The toolpath is the pieces now. Pieces of an arc are arcs. Lines of the source, runs and changes of color stay
    /// with their beads; a bead without a piece is gone.
    void finish();

private:
    void keep(const gcode::Bead& bead, const BeadPiece& piece);

    gcode::Toolpath& toolpath_;
    bool with_flow_;
    std::vector<gcode::Bead> beads_;
    std::vector<gcode::Arc> arcs_;
    std::vector<gcode::BeadFlow> flow_;
    std::vector<gcode::BeadTiming> timing_;
    std::vector<std::uint32_t> changes_;  // the first bead of each change of color that was met
};

}  // namespace stratum::deposit
