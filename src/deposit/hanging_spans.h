// The spans of a print that hang: level beads over nothing, between what carries them at both ends.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <cstdint>
#include <vector>

namespace stratum::deposit {

/// A stretch without support, along one bead or several that are joined.
struct HangingSpan {
    double length = 0;  ///< mm, in the plan
    int pieces = 2;     ///< into which it is cut; even, so that one ends in the middle
};

/// The part of a bead that is in a span.
struct HangingPart {
    std::uint32_t bead = 0;
    std::uint32_t span = 0;
    double from = 0, to = 0;  ///< mm of the bead's path
    double before = 0;        ///< mm of the span before this part
};

struct HangingSpans {
    std::vector<HangingSpan> spans;
    std::vector<HangingPart> parts;  ///< in print order
};

/// Shorter pieces than this are not made, and an end of a span that is closer to a joint moves there, mm.
constexpr double kLeastPiece = 1e-3;

/// Finds the spans of a chain of level beads, each beginning where the last ended, that nothing carries (bead_support.h
/// says what does) but that have support at both ends. Loose ends, loops without support, sloped beads, and spans
/// shorter than the widest of their beads, which the stiffness of the plastic carries, are none. Their numbers of
/// pieces, at most 32, are for a sag of `fraction` of the length. On all threads; the result is the same for any number
/// of them.
HangingSpans findHangingSpans(const gcode::Toolpath& toolpath, double fraction);

}  // namespace stratum::deposit
