// 512 bits, one a voxel of a leaf, in OpenVDB's order: word x, bit y * 8 + z.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace stratum::voxelize {

struct LeafMask {
    std::array<std::uint64_t, 8> word{};

    bool empty() const {
        std::uint64_t any = 0;
        for (const std::uint64_t w : word) any |= w;
        return any == 0;
    }
    bool operator==(const LeafMask&) const = default;
    static LeafMask full() {
        LeafMask mask;
        mask.word.fill(~std::uint64_t{0});
        return mask;
    }
};

/// The masks of a leaf and of its 26 neighbours; null stands for an empty one. Index (dx + 1) * 9 + (dy + 1) * 3 + dz
/// + 1.
using Neighbourhood = std::array<const LeafMask*, 27>;
constexpr std::size_t neighbourIndex(int dx, int dy, int dz) {
    return static_cast<std::size_t>(dx + 1) * 9 + static_cast<std::size_t>(dy + 1) * 3 +
           static_cast<std::size_t>(dz + 1);
}

/// Farthest that a bit can be seen from in the functions below, voxels.
constexpr int kFarthestReach = 8;

/// Whether a bit of the neighbourhood lies within `reach` voxels, along each axis, of the middle leaf, or in it.
bool anyWithin(const Neighbourhood& around, int reach);

/// What of the middle leaf lies within `reach` voxels (Euclidean, at most kFarthestReach) of a bit of the
/// neighbourhood.
LeafMask withinReach(const Neighbourhood& around, double reach);

/// What of the middle leaf the bits of `seeds` reach in at most `steps` (1..kFarthestReach) steps over faces, edges and
/// corners through `open`. Seeds count as reached, open or not.
LeafMask spreadThrough(const Neighbourhood& open, const Neighbourhood& seeds, int steps);

/// What of the middle leaf shares a face with a bit of the neighbourhood, or is such a bit itself.
LeafMask besides(const Neighbourhood& around);

/// The bits of `open` that `seeds` reach through `open`, from face to face. `seeds` outside `open` are dropped.
LeafMask floodWithin(const LeafMask& open, const LeafMask& seeds);

}  // namespace stratum::voxelize
