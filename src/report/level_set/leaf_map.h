// The leaves of a level set by column, and the uniform gaps between them: what a flood walks through.
#pragma once

#include "voxelize/beads/plan_index.h"

#include <openvdb/openvdb.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace stratum::report {

using Leaf = openvdb::FloatTree::LeafNodeType;

/// Columns of leaves, row by row of the plan; where no leaf is, there is no column. Between two leaves of a column,
/// below the first and above the last there is a gap, which may be empty: its voxels are all outside or all inside,
/// because no surface is near. A column of n leaves has n + 1 gaps. Refers to the grid's leaves: the grid must outlive
/// it and not change.
class LeafMap {
public:
    explicit LeafMap(const openvdb::FloatGrid& grid);

    struct Place {
        bool leaf = false;      ///< else a gap
        std::size_t index = 0;  ///< of leaf() or of gapInside()
    };

    std::size_t leafCount() const { return leaves_.size(); }
    /// By column, ascending in z within one.
    const Leaf& leaf(std::size_t n) const { return *leaves_[n]; }
    /// Coordinate over 8, of a leaf.
    int leafK(std::size_t n) const { return k_[n]; }
    std::size_t columnOf(std::size_t n) const { return column_of_[n]; }

    std::size_t columnCount() const { return first_.size() - 1; }
    int columnI(std::size_t c) const { return index_.squares()[c].x; }
    int columnJ(std::size_t c) const { return index_.squares()[c].y; }
    std::size_t firstLeaf(std::size_t c) const { return first_[c]; }
    static constexpr std::size_t kNowhere = ~std::size_t{0};
    /// The column of a place of the plan, or kNowhere.
    std::size_t columnAt(int i, int j) const {
        const std::uint32_t c = index_.find(i, j);
        return c == voxelize::PlanIndex::kNone ? kNowhere : c;
    }

    std::size_t gapCount() const { return gap_inside_.size(); }
    std::size_t firstGap(std::size_t c) const { return first_[c] + c; }
    /// Whether a gap is solid. False for empty ones.
    bool gapInside(std::size_t gap) const { return gap_inside_[gap] != 0; }
    /// Leaf coordinates [low, high) of gap `n` of a column; of those at the ends, as far as kEnd.
    struct Range {
        int low, high;
    };
    static constexpr int kEnd = 1 << 28;
    Range gapRange(std::size_t c, std::size_t n) const;

    /// What is at leaf coordinate `k` of a column.
    Place at(std::size_t c, int k) const;
    /// The same of a place of the plan; without a column it is a gap of number kNowhere.
    Place at(int i, int j, int k) const {
        const std::size_t c = columnAt(i, j);
        return c != kNowhere ? at(c, k) : Place{false, kNowhere};
    }

    /// A leaf and what lies beyond it where its cells end: number 1, 2, 4 and their sums along x, y and z.
    using CellPlaces = std::array<Place, 8>;
    CellPlaces cellPlaces(std::size_t n) const;
    /// Sample (x, y, z) of the 9 x 9 x 9 that a leaf's cells have at their corners; +-`outside` in gaps.
    void gather(const CellPlaces& places, float (&samples)[9][9][9], float outside) const;

private:
    voxelize::PlanIndex index_;  // of the columns
    std::vector<const Leaf*> leaves_;
    std::vector<int> k_;  // beside the leaves: searches touch no leaf
    std::vector<std::uint32_t> column_of_;
    std::vector<std::size_t> first_;
    std::vector<std::uint8_t> gap_inside_;
};

}  // namespace stratum::report
