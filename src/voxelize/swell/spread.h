// The surplus of a layer, spread to where outlines can move out: the arithmetic of swell_field.h.
#pragma once

#include "voxelize/swell/swell_field.h"

#include <vector>

namespace stratum::voxelize {

/// A square of nodes of one layer, row by row: sums of tents, mm^3.
struct SpreadNodes {
    int edge = 0;
    std::vector<double> surplus;
    std::array<std::vector<double>, TileSums::kLevels> gain;

    explicit SpreadNodes(int the_edge);
};

/// Nodes on each side of those whose swell is wanted.
constexpr int kSpreadHalo = 2 * (kNear + kFar);

/// What each node is given, mm^3: at most its gain at kMostSwell. Right for nodes kSpreadHalo or more from the edge.
std::vector<double> spreadSurplus(const SpreadNodes& nodes);

/// The swell (mm) that gains `given` at node `n`.
double swellThatGains(const SpreadNodes& nodes, std::size_t n, double given);

}  // namespace stratum::voxelize
