// LayerStack -> the beads that reach each leaf column, the 8 x 8 voxel columns of OpenVDB's leaves.
#pragma once

#include "base/huge_array.h"
#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/footprint.h"
#include "voxelize/beads/lattice.h"
#include "voxelize/beads/layer_stack.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace stratum::voxelize {

// Numbers the squares of the plan that are used, however far apart they lie.

/// Rounded down: the square of edge b in which a lies.
constexpr int floorDivide(int a, int b) { return a / b - (a % b < 0 ? 1 : 0); }

/// A hash table of places (x, y). Memory is in proportion to the squares that were added.
class PlanIndex {
public:
    static constexpr std::uint32_t kNone = 0xffffffff;
    struct Square {
        int x = 0, y = 0;
        bool operator==(const Square&) const = default;
    };

    /// The number of a square, or kNone.
    std::uint32_t find(int x, int y) const {
        if (table_.empty()) return kNone;
        return table_[slotOf({x, y})];
    }
    /// The same; one that is not there gets the next number.
    std::uint32_t add(int x, int y) {
        if (2 * (squares_.size() + 1) > table_.size()) grow();
        std::uint32_t& number = table_[slotOf({x, y})];
        if (number == kNone) {
            number = static_cast<std::uint32_t>(squares_.size());
            squares_.push_back({x, y});
        }
        return number;
    }
    std::size_t size() const { return squares_.size(); }
    /// By number.
    const std::vector<Square>& squares() const { return squares_; }
    std::size_t bytes() const { return squares_.capacity() * sizeof(Square) + table_.capacity() * sizeof(table_[0]); }

private:
    // Where the square is, or would be: the table is at most half full.
    std::size_t slotOf(const Square& square) const {
        const std::uint64_t key = static_cast<std::uint64_t>(static_cast<std::uint32_t>(square.x)) << 32 |
                                  static_cast<std::uint32_t>(square.y);
        const std::uint64_t mixed = (key ^ key >> 32) * 0x9e3779b97f4a7c15U;
        std::size_t slot = static_cast<std::size_t>(mixed >> 32) & (table_.size() - 1);
        while (table_[slot] != kNone && squares_[table_[slot]] != square) slot = (slot + 1) & (table_.size() - 1);
        return slot;
    }
    void grow() {
        constexpr std::size_t kFewest = 16;
        table_.assign(table_.empty() ? kFewest : 2 * table_.size(), kNone);
        for (std::size_t n = 0; n < squares_.size(); ++n) table_[slotOf(squares_[n])] = static_cast<std::uint32_t>(n);
    }

    std::vector<Square> squares_;
    std::vector<std::uint32_t> table_;  // a power of two
};

/// Voxels along the edge of a leaf, and of a leaf column in the plane.
constexpr int kLeafDim = 8;

/// Finds the leaf columns that a bead's field reaches.
inline Footprints columnFootprints(const gcode::Toolpath& toolpath, const Lattice& lattice) {
    return {toolpath, lattice.voxel_size * kLeafDim, 0.5 * (kLeafDim - 1) * lattice.voxel_size, lattice.background(),
            Footprints::Reach::field};
}

/// Ranks of beads (see LayerStack) by leaf column, in CSR form; ascending within a column, so layer by layer with the
/// direct beads last. Only columns that beads reach are listed: block by block, row by row within one. The blocks are
/// in the order of a .vdb file: by OpenVDB's upper nodes (x, then y), then by x and y.
class PlanBins {
public:
    /// Columns along each edge of a block: that of OpenVDB's lower internal nodes.
    static constexpr int kBlockColumns = 16;
    static constexpr std::size_t kNone = ~std::size_t{0};
    struct Block {
        int x = 0, y = 0;       ///< in blocks
        std::size_t first = 0;  ///< its columns are [first, last)
        std::size_t last = 0;
        std::array<std::uint16_t, kBlockColumns> rows{};    ///< bit i of row j: the column is listed
        std::array<std::uint16_t, kBlockColumns> before{};  ///< columns in the rows before

        /// Of a column that is listed; within the block.
        std::size_t columnAt(int i, int j) const {
            const auto row = static_cast<std::size_t>(j);
            const unsigned left = rows[row] & ((1U << static_cast<unsigned>(i)) - 1);
            return first + before[row] + static_cast<std::size_t>(std::popcount(left));
        }
        bool has(int i, int j) const { return (rows[static_cast<std::size_t>(j)] >> i & 1) != 0; }
    };

    /// Bins every bead whose band reaches a column. Parallel; the result does not depend on the number of threads.
    /// Throws UsageError if that needs more than a quarter of `free_memory` bytes.
    PlanBins(const gcode::Toolpath& toolpath, const LayerStack& stack, const Lattice& lattice, std::size_t free_memory);

    std::size_t size() const { return places_.size(); }
    std::span<const std::uint32_t> operator[](std::size_t column) const {
        return {ranks_.data() + offsets_[column], ranks_.data() + offsets_[column + 1]};
    }
    /// By column.
    std::span<const PlanIndex::Square> places() const { return places_; }
    /// In columns, from index 0.
    int columnI(std::size_t column) const { return places_[column].x; }
    int columnJ(std::size_t column) const { return places_[column].y; }
    /// Index-space coordinate of the first voxel of a column: a multiple of kLeafDim.
    int originI(std::size_t column) const { return places_[column].x * kLeafDim; }
    int originJ(std::size_t column) const { return places_[column].y * kLeafDim; }
    /// The column of this place, in columns from index 0, or kNone.
    std::size_t find(int i, int j) const {
        const std::uint32_t n = index_.find(i >> kBlockBits, j >> kBlockBits);
        if (n == PlanIndex::kNone) return kNone;
        const Block& block = blocks_[n];
        const int in_i = i & (kBlockColumns - 1);
        const int in_j = j & (kBlockColumns - 1);
        return block.has(in_i, in_j) ? block.columnAt(in_i, in_j) : kNone;
    }

    const std::vector<Block>& blocks() const { return blocks_; }
    /// The number of the block that a column lies in.
    std::size_t blockOf(std::size_t column) const {
        return index_.find(places_[column].x >> kBlockBits, places_[column].y >> kBlockBits);
    }
    /// The rectangle of the beads' boxes, in columns; most of it may be empty.
    const ColumnRange& rectangle() const { return rectangle_; }
    std::size_t entryCount() const { return ranks_.size(); }
    std::size_t bytes() const {
        return offsets_.capacity() * sizeof(std::size_t) + ranks_.size() * sizeof(std::uint32_t) +
               places_.capacity() * sizeof(PlanIndex::Square) + blocks_.capacity() * sizeof(Block) + index_.bytes();
    }

private:
    static constexpr int kBlockBits = 4;
    static_assert(kBlockColumns == 1 << kBlockBits);

    ColumnRange rectangle_;
    PlanIndex index_;  // of blocks_
    std::vector<Block> blocks_;
    std::vector<PlanIndex::Square> places_;  // by column
    std::vector<std::size_t> offsets_;
    HugeArray<std::uint32_t> ranks_;
};

/// std::lower_bound of a column's ranks, not empty, of a stack of `of_all` beads. An interpolation search: the list is
/// rarely in the cache, and bisection would touch more of it.
std::size_t firstNotBelow(std::span<const std::uint32_t> ranks, std::uint32_t rank, std::size_t of_all);

}  // namespace stratum::voxelize
