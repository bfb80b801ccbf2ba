// LayerStack -> leaves in the order of a .vdb file, without a grid.
#pragma once

#include "voxelize/grid/leaf_receiver.h"
#include "voxelize/leaf/print_columns.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace stratum::voxelize {

/// What a tree of OpenVDB has at most.
struct NodeBounds {
    std::size_t leaves = 0;
    std::size_t lower_nodes = 0, upper_nodes = 0;
};

/// What a print has at most, from z extents alone.
struct LeafBounds : NodeBounds {
    LeafRange heights{0, -1};        ///< of all columns
    std::vector<LeafRange> columns;  ///< by column of the bins; empty ones have first > second
};
/// Parallel. `heights`: of all beads.
LeafBounds boundLeaves(const PrintColumns& columns, const LeafRange& heights);

struct LeafStreamReport {
    std::size_t evaluated = 0;  ///< leaf positions
    std::size_t leaves = 0;     ///< with something active
    double volume_voxels = 0;   ///< inside; 0 unless `measure`
    std::size_t measured = 0;   ///< leaves in which that was measured
};

/// Makes all leaves of the beads with an index in the toolpath below `end`, with the bits of Voxelizer::printUntil(),
/// and gives them to `receiver`. Columns that reach into more than one of OpenVDB's upper nodes are opened once for
/// each. Parallel; calls and their order do not depend on the number of threads.
LeafStreamReport streamLeaves(const PrintColumns& columns, std::uint32_t end, const LeafBounds& bounds,
                              LeafReceiver& receiver, bool measure, const std::function<void(double)>& progress);

}  // namespace stratum::voxelize
