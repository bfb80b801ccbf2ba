// The upper level of bricks: which bricks of 32^3 cells have surface, and how far a ray meets none.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <span>

namespace stratum::march {

/// 4^3 bits, x slowest: occupancy of (x, y, z), and the size of the empty block around a position.
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
    std::uint64_t bricks = 0;  ///< Mask64 of the bricks that are kept
    /// With bricks, the index of the first of them in four bytes. Without, emptyAhead() by octant.
    std::array<std::uint8_t, 8> rest{};

    std::uint32_t firstBrick() const {
        std::uint32_t first = 0;
        std::memcpy(&first, rest.data(), sizeof first);
        return first;
    }
    void setFirstBrick(std::uint32_t first) { std::memcpy(rest.data(), &first, sizeof first); }
    /// Of one without bricks: the edge, in macro cells, of the largest cube from this one on in which all are empty, at
    /// most 255. Beyond the grid everything is empty. The octant tells along which axes directions descend: 4 for x, 2
    /// for y, 1 for z.
    int emptyAhead(unsigned octant) const { return rest[octant]; }
};

/// Finds emptyAhead() of all macro cells, x slowest and z fastest, for all octants, on all threads. After Deakin and
/// Knackstedt, "Efficient ray casting of volumetric images using distance maps for empty space skipping"
/// (Computational Visual Media 6(1), 2020): rays leave empty space in fewer steps than by distances in all directions.
void measureEmptySpace(std::span<MacroCell> macros, const std::array<int, 3>& count);

}  // namespace stratum::march
