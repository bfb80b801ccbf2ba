// Builds only what the outside can reach.
//
// A closed print is mostly inner surfaces: infill, gaps between beads. The flood starts in the open air around the part
// and evaluates a leaf when it arrives there, so leaves that no outside point reaches never exist. Two outside samples
// (phi >= 0) of one cell, the cube of eight samples that a ray crosses, count as connected, even over a corner. Where a
// ray can pass, the trilinear field is not negative somewhere on each cell face it crosses, so one of that face's
// corners is outside, and it belongs to both cells: no ray gets anywhere that the flood does not.
#pragma once

#include "voxelize/leaf_column.h"
#include "voxelize/plan_bins.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace stratum::voxelize {

/// Gives each calling thread a LeafColumn of its own.
using ColumnSource = std::function<LeafColumn&()>;

struct ExteriorCounts {
    std::size_t positions = 0;  ///< leaf positions that `keep` would have to evaluate
    std::size_t evaluated = 0;
    std::size_t kept = 0;
    int rounds = 0;
    double flood_seconds = 0;     ///< thread time: masks and queues
    double evaluate_seconds = 0;  ///< thread time: distances
};

/// Leaves with at least one active voxel by column, to be owned by the caller. Values where the outside can reach are
/// those of the whole level set, and so are those inside that lie within `band` voxels (1..8, along each axis) of a
/// reachable sample; every other voxel is inside. `background` in world units. Parallel; the result does not depend on
/// the number of threads. `progress` gets leaves evaluated so far.
ExteriorCounts buildReachable(const PlanBins& bins, const ColumnSource& columns, std::uint32_t end, float background,
                              int band, std::vector<std::vector<Leaf*>>& leaves);

}  // namespace stratum::voxelize
