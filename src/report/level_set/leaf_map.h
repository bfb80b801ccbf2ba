// The leaves of a level set by column, and the uniform gaps between them.
#pragma once

#include "voxelize/leaf/leaf_positions.h"

#include <openvdb/openvdb.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace stratum::report {

using Leaf = openvdb::FloatTree::LeafNodeType;

/// Columns of leaves, row by row of the plan; where no leaf is, there is no column. The voxels of a gap are all outside
/// or all inside, because no surface is near. Refers to the grid's leaves: the grid must outlive it and not change.
class LeafMap {
public:
    explicit LeafMap(const openvdb::FloatGrid& grid);

    using Place = voxelize::LeafPositions::Place;  // of leaf() or of gapInside()
    static constexpr std::size_t kNowhere = voxelize::LeafPositions::kNowhere;

    /// Slots are the numbers of leaves.
    const voxelize::LeafPositions& positions() const { return positions_; }
    std::size_t leafCount() const { return leaves_.size(); }
    /// By column, ascending in z within one.
    const Leaf& leaf(std::size_t n) const { return *leaves_[n]; }
    /// Coordinate over 8, of a leaf.
    int leafK(std::size_t n) const { return k_[n]; }
    std::size_t columnOf(std::size_t n) const { return column_of_[n]; }
    std::size_t firstLeaf(std::size_t c) const { return positions_.intervalsOf(c).front().slot; }

    /// Whether a gap is solid.
    bool gapInside(std::size_t gap) const { return gap_inside_[gap] != 0; }
    /// By gap.
    std::span<const std::uint8_t> solidGaps() const { return gap_inside_; }

    /// A leaf and what lies beyond it where its cells end: number 1, 2, 4 and their sums along x, y and z.
    using CellPlaces = std::array<Place, 8>;
    CellPlaces cellPlaces(std::size_t n) const;
    /// Sample (x, y, z) of the 9 x 9 x 9 that a leaf's cells have at their corners; +-`outside` in gaps.
    void gather(const CellPlaces& places, float (&samples)[9][9][9], float outside) const;

private:
    voxelize::LeafPositions positions_;
    // By leaf.
    std::vector<const Leaf*> leaves_;
    std::vector<int> k_;  // beside the leaves: searches touch no leaf
    std::vector<std::uint32_t> column_of_;
    std::vector<std::uint8_t> gap_inside_;
};

}  // namespace stratum::report
