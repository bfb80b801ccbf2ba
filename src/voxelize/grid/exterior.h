// Builds only the leaves that are reachable from outside the part.
//
// Most surfaces of a closed print are inside: infill, channels between beads. A flood fill starts around the part and
// evaluates a leaf when it arrives there, so leaves that it doesn't reach are never built.
//
// Printed parts are not airtight: between beads laid side by side there is a channel, 0.27 layer heights wide at the
// planned spacing, which reaches the outside somewhere. So the flood takes only samples whose distance to the surface
// is at least a clearance (the narrowest opening it passes is twice the clearance). Voxels around the flood, up to a
// depth, are shown whatever their width: grooves, steps, the sides of layers.
#pragma once

#include "voxelize/leaf/print_columns.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace stratum::voxelize {

struct ExteriorCounts {
    std::size_t positions = 0;  ///< leaf positions that Interior::keep would evaluate
    std::size_t evaluated = 0;
    std::size_t kept = 0;         ///< leaves
    std::size_t kept_voxels = 0;  ///< active ones
    int rounds = 0;
    double evaluate_seconds = 0;  ///< sum over the threads: distances
};

struct ExteriorRule {
    float background = 0;  ///< world units
    float clearance = 0;   ///< world units: the flood passes where phi is at least this
    int depth = 3;         ///< voxels, 1..8: openings narrower than the flood passes are shown up to this depth
    double band = 2;       ///< voxels, 1..8: voxels inside the solid stay active within this distance of shown ones
};

/// The clearance of a lattice, mm: half a voxel, so that the narrowest gap that the flood passes is a voxel wide; but
/// not the channels of planned spacing, however fine the voxel. With h the layer height their clear radius is
/// h (sqrt((pi / 8)^2 + 1 / 4) - 1 / 2) = 0.136 h.
inline double exteriorClearance(const Lattice& lattice) {
    constexpr double kChannelRadius = 0.15;  // layer heights
    return std::max(0.5 * lattice.voxel_size, kChannelRadius * lattice.layer_height);
}

/// Leaves with at least one active voxel, by column.
using LeavesByColumn = std::vector<std::vector<std::unique_ptr<Leaf>>>;

/// Fills `leaves`. Shown voxels, and voxels inside within the band around them, have the values of the whole level set;
/// every other voxel is inside. Parallel; the result does not depend on the number of threads. The number of leaves is
/// unknown in advance: `progress` gets the share of all positions reached so far, and 1 at the end; one thread at a
/// time.
ExteriorCounts buildReachable(const PrintColumns& columns, std::uint32_t end, const ExteriorRule& rule,
                              LeavesByColumn& leaves, const std::function<void(double)>& progress = {});

/// Counts what buildReachable would keep. Reads the values from the whole grid of the same beads, which must not change
/// meanwhile, and evaluates no distance.
ExteriorCounts countReachable(const PrintColumns& columns, std::uint32_t end, const ExteriorRule& rule,
                              const openvdb::FloatTree& whole);

}  // namespace stratum::voxelize
