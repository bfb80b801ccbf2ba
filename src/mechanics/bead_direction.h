// The direction in which the bead of an element was laid: the first axis of an orthotropic material.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <cstdint>
#include <tuple>

namespace stratum::mechanics {

/// To whole degrees, so that elements of one direction share a section: half a degree changes a modulus by less than
/// 1e-4 of its difference to the others. Forward and backward are one direction.
struct BeadDirection {
    std::int16_t azimuth = 0;    ///< degrees from x to y, 0..179
    std::int16_t elevation = 0;  ///< degrees above the plan, -90..90; 0 for level beads
    bool operator==(const BeadDirection&) const = default;
    bool operator<(const BeadDirection& other) const {
        return std::tie(azimuth, elevation) < std::tie(other.azimuth, other.elevation);
    }
};

/// At the place of the bead that is nearest to (x, y), mm: arcs turn. Beads of no length: along x.
BeadDirection directionAt(const gcode::Toolpath& toolpath, const gcode::Bead& bead, double x, double y);

}  // namespace stratum::mechanics
