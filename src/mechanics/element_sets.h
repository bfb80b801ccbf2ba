// Sets of elements and nodes by what they were printed as, and by where they are.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "mechanics/hexahedra.h"
#include "mechanics/solid_elements.h"

#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

namespace stratum::mechanics {

// The direction in which the bead of an element was laid: the first axis of an orthotropic material.

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

/// Consecutive numbers, from 0, both included.
struct NumberRange {
    std::uint32_t first = 0, last = 0;
};

struct NamedSet {
    std::string name;  ///< capitals, digits and underscores
    std::vector<NumberRange> members;
};

/// LAYER_n, FEATURE_name and TOOL_n of the nearest bead; sets that are empty are left out.
std::vector<NamedSet> elementSets(const SolidElements& elements, const gcode::Toolpath& toolpath);

/// The nodes of those elements, under the same names; and BED and TOP, XMIN, XMAX, YMIN and YMAX: the nodes of the
/// outermost plane of each side. A print on a belt, whose cubes lean, has XMIN and XMAX alone.
std::vector<NamedSet> nodeSets(const SolidElements& elements, const Hexahedra& mesh, const gcode::Toolpath& toolpath);

/// ALONG_azimuth, and ALONG_azimuth_UP_elevation of sloped beads: every element is in one.
std::map<BeadDirection, NamedSet> directionSets(const SolidElements& elements, const gcode::Toolpath& toolpath);

}  // namespace stratum::mechanics
