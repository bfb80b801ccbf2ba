// Beads over nothing hang between what carries them.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <cstddef>

namespace stratum::deposit {

/// What sagged.
struct SagReport {
    std::size_t spans = 0;
    double length_mm = 0;   ///< of all spans, in the plan
    double deepest_mm = 0;  ///< the largest drop
};

/// Largest `fraction`; larger ones count as this.
constexpr double kMostSag = 0.5;

/// Lets level beads hang where nothing carries them (bead_support.h says what does, below them and beside). A span is
/// an unsupported part of a chain of level beads, each beginning where the last ended, with support at both of its
/// ends. Over a span of length L in the plan, the place at s (mm) drops by
///     4 fraction s (L - s) / L        (mm; fraction L in the middle)
/// but no steeper than 0.99 from the two ends, so that a piece stays below 45 degrees; that matters for fractions above
/// 0.2475. Loose ends, loops without support, sloped beads, and spans shorter than the widest of their beads, which the
/// stiffness of the plastic carries, stay as they are.
///
/// A span becomes as many sloped pieces as follow that curve within 1 % of a bead's height, but at most 32 and one more
/// for each joint of its beads. Pieces get the widths that keep the volume. What carries a bead is taken from the
/// toolpath as it was: the layer above a span lies on where it would have been. Without a span, or with a fraction not
/// above 0, the toolpath is not touched.
SagReport sagBeads(gcode::Toolpath& toolpath, double fraction);

}  // namespace stratum::deposit
