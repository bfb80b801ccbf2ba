// The blocks of a print's leaves (LeafReceiver), in the order of the file.
#pragma once

#include "voxelize/beads/plan_bins.h"
#include "voxelize/grid/leaf_receiver.h"
#include "voxelize/leaf/leaf_column.h"

#include <openvdb/openvdb.h>

#include <algorithm>
#include <cstddef>

namespace stratum::voxelize {

constexpr int kSlabLeaves = kSlabVoxels / kLeafDim;  ///< along each axis of an upper node
constexpr int kBlockLeaves = kBlockVoxels / kLeafDim;

inline int floorDivide(int a, int b) { return a / b - (a % b < 0 ? 1 : 0); }

/// Columns of leaves, inclusive, from index 0.
struct LeafRectangle {
    int first_i, last_i, first_j, last_j;
};

/// All columns of the bins.
inline LeafRectangle rectangleOf(const PlanBins& bins) {
    const int i = bins.originI(0) / kLeafDim;
    const int j = bins.originJ(0) / kLeafDim;
    return {i, i + static_cast<int>(bins.columnsI()) - 1, j, j + static_cast<int>(bins.columnsJ()) - 1};
}

/// The cells of a lattice of this edge that an interval meets.
inline std::size_t cellsMet(int first, int last, int edge) {
    return static_cast<std::size_t>(floorDivide(last, edge)) - static_cast<std::size_t>(floorDivide(first, edge)) + 1;
}

/// The part of a pile of columns that lies in one upper node and in the rectangle of the bins.
struct LeafBlock {
    int x = 0, y = 0;  ///< in blocks
    LeafRectangle plan{};
    LeafRange heights;

    /// Its first voxel.
    openvdb::Coord origin() const {
        return {x * kBlockVoxels, y * kBlockVoxels, floorDivide(heights.first, kSlabLeaves) * kSlabVoxels};
    }
};

/// What of a column lies between these heights, leaves.
inline std::size_t leavesIn(const LeafRange& heights, const LeafRange& column) {
    const int first = std::max(column.first, heights.first);
    const int last = std::min(column.second, heights.second);
    return first <= last ? static_cast<std::size_t>(last - first) + 1 : 0;
}

/// The cells of a lattice of this edge that a rectangle meets, clipped to it: visit(x, y, clipped), by x, then y.
template <typename Visit>
void forEachCell(const LeafRectangle& all, int edge, const Visit& visit) {
    for (int x = floorDivide(all.first_i, edge); x <= floorDivide(all.last_i, edge); ++x)
        for (int y = floorDivide(all.first_j, edge); y <= floorDivide(all.last_j, edge); ++y)
            visit(x, y,
                  LeafRectangle{std::max(all.first_i, x * edge), std::min(all.last_i, (x + 1) * edge - 1),
                                std::max(all.first_j, y * edge), std::min(all.last_j, (y + 1) * edge - 1)});
}

/// visit(block) of all blocks between these heights, empty ones too.
template <typename Visit>
void forEachBlock(const LeafRectangle& all, const LeafRange& heights, const Visit& visit) {
    forEachCell(all, kSlabLeaves, [&](int, int, const LeafRectangle& upper) {
        for (int slab = floorDivide(heights.first, kSlabLeaves); slab <= floorDivide(heights.second, kSlabLeaves);
             ++slab)
            forEachCell(upper, kBlockLeaves, [&](int x, int y, const LeafRectangle& plan) {
                visit(LeafBlock{x,
                                y,
                                plan,
                                {std::max(heights.first, slab * kSlabLeaves),
                                 std::min(heights.second, (slab + 1) * kSlabLeaves - 1)}});
            });
    });
}

/// visit(bin, number in the block) of each column, in the order of the file.
template <typename Visit>
void forEachColumnOf(const LeafBlock& block, const PlanBins& bins, const Visit& visit) {
    const LeafRectangle all = rectangleOf(bins);
    for (int i = block.plan.first_i; i <= block.plan.last_i; ++i)
        for (int j = block.plan.first_j; j <= block.plan.last_j; ++j)
            visit(
                static_cast<std::size_t>(j - all.first_j) * bins.columnsI() + static_cast<std::size_t>(i - all.first_i),
                static_cast<std::size_t>(i - block.x * kBlockLeaves) * kBlockLeaves +
                    static_cast<std::size_t>(j - block.y * kBlockLeaves));
}

}  // namespace stratum::voxelize
