// Spans over nothing hang (findHangingSpans() finds them).
#pragma once

#include "deposit/bead_cutter.h"
#include "gcode/toolpath/toolpath.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace stratum::deposit {

// The spans of a print that hang: level beads over nothing, between what carries them at both ends.

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

/// What sagged.
struct SagReport {
    std::size_t spans = 0;
    double length_mm = 0;   ///< of all spans, in the plan
    double deepest_mm = 0;  ///< the largest drop
};

/// Largest `fraction`; larger ones count as this.
constexpr double kMostSag = 0.5;

/// How far (mm) a span of this length (mm) hangs at s (mm of it); see Sag. The fraction is at most kMostSag.
double sagDrop(double length, double s, double fraction);

/// Lets a print sag while its beads are cut. Over a span of length L in the plan, the place at s (mm) drops by
///     4 fraction s (L - s) / L        (mm; fraction L in the middle)
/// but no steeper than 0.99 from the two ends, so that a piece stays below 45 degrees; that matters for fractions above
/// 0.2475. Pieces follow that curve within 1 % of a bead's height, where their bounded number allows, and get the
/// widths that keep the volume. What carries a bead is taken from the file's beads: the layer above a span lies on
/// where it would have been, and flow changes no support.
class Sag {
public:
    /// Finds the spans. The toolpath must stay as it is meanwhile.
    Sag(const gcode::Toolpath& toolpath, double fraction);

    bool none() const { return hanging_.spans.empty(); }
    SagReport report() const;

    /// Lays this piece, cut where it hangs. Pieces must come in the order of their beads.
    void lay(const BeadPiece& piece, BeadCutter& cutter);

private:
    void addHanging(const HangingPart& part, double from, double to);
    void add(double from, double to, double drop0, double drop1);
    double heightOf() const;
    double areaOf(double width) const;

    const gcode::Toolpath& toolpath_;
    double fraction_;
    HangingSpans hanging_;
    std::size_t next_ = 0;  // of hanging_.parts
    // Of the piece that is cut:
    BeadPiece source_;
    double length_ = 0;              // mm, of its bead
    std::vector<BeadPiece> pieces_;  // and their shares of the volume
    std::vector<double> weights_;
};

/// The sag alone, without flow. Without a span, or with a fraction not above 0, the toolpath is not touched.
SagReport sagBeads(gcode::Toolpath& toolpath, double fraction);

}  // namespace stratum::deposit
