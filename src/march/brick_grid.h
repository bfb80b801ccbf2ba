// FloatGrid -> bricks: the level set laid out for rays.
//
// Three levels over the cells of the grid (a cell is the cube between eight neighbouring samples):
//   macro cell   32^3 cells, in a dense array: which of its 4^3 bricks have surface, or how far the next such macro
//                cell is (Chebyshev distance), so that rays leave empty space in large boxes
//   brick        8^3 cells: a bit for every surface cell (corners not of one sign), and the 9^3 samples at its corners
// Only bricks with a surface cell are kept. All coordinates are cells, counted from the grid's lowest corner.
#pragma once

#include "march/huge_array.h"

#include <openvdb/openvdb.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace stratum::march {

/// 4^3 bits, x slowest: whether something is at (x, y, z), and how large a part around a place is empty.
struct Mask64 {
    static constexpr int bit(int x, int y, int z) { return x << 4 | y << 2 | z; }
    /// Bits of the aligned 2^3 group at even (x, y, z).
    static constexpr std::uint64_t group(int x, int y, int z) {
        constexpr std::uint64_t kPair = 0b11;  // two along z
        constexpr std::uint64_t kQuad = kPair | kPair << 4;
        constexpr std::uint64_t kGroup = kQuad | kQuad << 16;
        return kGroup << bit(x & 2, y & 2, z & 2);
    }
    /// Edge of the largest aligned empty block around (x, y, z): 4, 2 or 1; 0 if that bit is set.
    static constexpr int emptyEdge(std::uint64_t mask, int x, int y, int z) {
        if (mask == 0) return 4;
        if ((mask & group(x, y, z)) == 0) return 2;
        return (mask >> bit(x, y, z) & 1) == 0 ? 1 : 0;
    }
};

/// 32^3 cells.
struct MacroCell {
    std::uint64_t bricks = 0;        ///< Mask64 of the bricks that are kept
    std::uint32_t first_brick = 0;   ///< index of the first of them
    std::uint32_t empty_radius = 0;  ///< if there are none: all macro cells nearer than this (Chebyshev) are empty too
};

class BrickGrid {
public:
    static constexpr int kMacroEdge = 32;  ///< cells
    static constexpr int kBrickEdge = 8;   ///< cells
    static constexpr int kSamples = kBrickEdge + 1;
    /// Strides of a brick's samples.
    static constexpr std::ptrdiff_t kStrideY = kSamples;
    static constexpr std::ptrdiff_t kStrideX = kStrideY * kSamples;

    using Surface = std::array<std::uint64_t, 8>;  ///< Mask64 of each 4^3 cells; x slowest
    using Samples = std::array<float, static_cast<std::size_t>(kStrideX* kSamples)>;  ///< world units; x slowest

    /// Builds from a level set; parallel. The grid may be released afterwards. Throws InputError, with the size, for a
    /// grid whose box holds more than 2^31 macro cells, and, with the place, for samples that are no finite numbers.
    explicit BrickGrid(const openvdb::FloatGrid& grid);

    /// Index-space coordinate of cell (0, 0, 0).
    const openvdb::Coord& origin() const { return origin_; }
    /// Cells along each axis: a multiple of kMacroEdge.
    const std::array<int, 3>& size() const { return size_; }

    const MacroCell& macroCell(int x, int y, int z) const {
        return macro_cells_[(static_cast<std::size_t>(x) * static_cast<std::size_t>(macros_[1]) +
                             static_cast<std::size_t>(y)) *
                                static_cast<std::size_t>(macros_[2]) +
                            static_cast<std::size_t>(z)];
    }
    /// Index of a brick that is set in its macro cell's mask; (x, y, z) in bricks within the macro cell.
    static std::size_t brickIndex(const MacroCell& macro, int x, int y, int z) {
        const std::uint64_t before = (std::uint64_t{1} << Mask64::bit(x, y, z)) - 1;
        return macro.first_brick + static_cast<std::size_t>(std::popcount(macro.bricks & before));
    }
    const Surface& surface(std::size_t brick) const { return surfaces_[brick]; }
    const float* samples(std::size_t brick) const { return samples_[brick].data(); }

    /// The same as arrays, for vector code.
    const MacroCell* macroCells() const { return macro_cells_.data(); }
    const Surface* surfaces() const { return surfaces_.data(); }

    std::size_t brickCount() const { return surfaces_.size(); }
    std::size_t bytes() const;

private:
    void measureEmptySpace();

    openvdb::Coord origin_;
    std::array<int, 3> macros_{};
    std::array<int, 3> size_{};
    HugeArray<MacroCell> macro_cells_;
    HugeArray<Surface> surfaces_;
    HugeArray<Samples> samples_;
};

}  // namespace stratum::march
