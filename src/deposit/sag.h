// Spans over nothing hang (hanging_spans.h finds them).
#pragma once

#include "deposit/bead_cutter.h"
#include "deposit/hanging_spans.h"
#include "gcode/toolpath/toolpath.h"

#include <cstddef>
#include <vector>

namespace stratum::deposit {

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
