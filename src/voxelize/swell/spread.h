// The surplus of a layer, spread to where outlines can move out and tops can rise: the arithmetic of swell_field.h.
#pragma once

#include "voxelize/swell/swell_field.h"

#include <vector>

namespace stratum::voxelize {

/// A square of nodes of one layer, row by row: sums of tents, mm^3 and mm^2. Floats: their rounding is a millionth of
/// what a node holds.
struct SpreadNodes {
    int edge = 0;
    std::vector<float> surplus;
    std::array<std::vector<float>, TileSums::kLevels> gain;
    std::vector<float> open;

    explicit SpreadNodes(int the_edge);
};

/// By node, mm^3. Together they are the surplus.
struct Spread {
    std::vector<float> given;   ///< at most the node's gain at kMostSwell
    std::vector<float> raised;  ///< at most its open area times `most_rise`
    std::vector<float> left;    ///< what has no place in this layer; below 0 where it holds more than was fed
};

/// Nodes on each side of those whose swell is wanted.
constexpr int kSpreadHalo = 2 * (kNear + kUp + kFar);

/// Right for nodes kSpreadHalo or more from the edge. `most_rise`: mm.
Spread spreadSurplus(const SpreadNodes& nodes, double most_rise);

/// The swell (mm) that gains `given` at node `n`.
double swellThatGains(const SpreadNodes& nodes, std::size_t n, double given);

}  // namespace stratum::voxelize
