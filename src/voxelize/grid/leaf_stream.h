// LayerStack -> leaves in the order of a .vdb file, without a grid.
#pragma once

#include "voxelize/beads/plan_bins.h"
#include "voxelize/grid/leaf_receiver.h"
#include "voxelize/leaf/leaf_column.h"
#include "voxelize/leaf/print_columns.h"

#include <openvdb/openvdb.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace stratum::voxelize {

// The blocks of a print's leaves (LeafReceiver), in the order of the file.

constexpr int kSlabLeaves = kSlabVoxels / kLeafDim;  ///< along each axis of an upper node
constexpr int kBlockLeaves = kBlockVoxels / kLeafDim;

/// The cells of a lattice of this edge that an interval meets.
inline std::size_t cellsMet(int first, int last, int edge) {
    return static_cast<std::size_t>(floorDivide(last, edge)) - static_cast<std::size_t>(floorDivide(first, edge)) + 1;
}

/// The part of a pile of columns that lies in one upper node.
struct LeafBlock {
    const PlanBins::Block* columns = nullptr;
    LeafRange heights;

    /// Its first voxel.
    openvdb::Coord origin() const {
        return {columns->x * kBlockVoxels, columns->y * kBlockVoxels,
                floorDivide(heights.first, kSlabLeaves) * kSlabVoxels};
    }
};

/// What of a column lies between these heights, leaves.
inline std::size_t leavesIn(const LeafRange& heights, const LeafRange& column) {
    const int first = std::max(column.first, heights.first);
    const int last = std::min(column.second, heights.second);
    return first <= last ? static_cast<std::size_t>(last - first) + 1 : 0;
}

/// The parts of these heights that lie in different upper nodes.
inline std::vector<LeafRange> slabsOf(const LeafRange& heights) {
    std::vector<LeafRange> slabs;
    for (int slab = floorDivide(heights.first, kSlabLeaves); slab <= floorDivide(heights.second, kSlabLeaves); ++slab)
        slabs.emplace_back(std::max(heights.first, slab * kSlabLeaves),
                           std::min(heights.second, (slab + 1) * kSlabLeaves - 1));
    return slabs;
}

/// visit(first, last) of the blocks [first, last) that lie in one column of upper nodes.
template <typename Visit>
void forEachUpper(const PlanBins& bins, const Visit& visit) {
    constexpr int kUpperBlocks = kSlabLeaves / PlanBins::kBlockColumns;
    const std::vector<PlanBins::Block>& blocks = bins.blocks();
    const auto upper = [&](std::size_t n) {
        return std::pair(floorDivide(blocks[n].x, kUpperBlocks), floorDivide(blocks[n].y, kUpperBlocks));
    };
    for (std::size_t first = 0; first < blocks.size();) {
        std::size_t last = first + 1;
        while (last < blocks.size() && upper(last) == upper(first)) ++last;
        visit(first, last);
        first = last;
    }
}

/// visit(block) of all blocks between these heights, in the order of the file; some may have no leaves there.
template <typename Visit>
void forEachBlock(const PlanBins& bins, const LeafRange& heights, const Visit& visit) {
    const std::vector<LeafRange> slabs = slabsOf(heights);
    forEachUpper(bins, [&](std::size_t first, std::size_t last) {
        for (const LeafRange& slab : slabs)
            for (std::size_t n = first; n < last; ++n) visit(LeafBlock{&bins.blocks()[n], slab});
    });
}

/// The number of a column in its block: see LeafReceiver::leaf().
inline std::size_t placeInBlock(const PlanBins& bins, std::size_t column) {
    static_assert(kBlockVoxels == PlanBins::kBlockColumns * kLeafDim);
    constexpr int kMask = PlanBins::kBlockColumns - 1;
    return static_cast<std::size_t>(bins.columnI(column) & kMask) * PlanBins::kBlockColumns +
           static_cast<std::size_t>(bins.columnJ(column) & kMask);
}

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
