// 512 bits, one a voxel of a leaf, in OpenVDB's order: word x, bit y * 8 + z.
#pragma once

#include <array>
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

/// The largest distance in the functions below, voxels.
constexpr int kFarthestReach = 8;

/// Whether the neighbourhood has a bit in the middle leaf or at most `reach` voxels from it along each axis.
bool anyWithin(const Neighbourhood& around, int reach);

/// The middle leaf of the neighbourhood's dilation by a ball of radius `reach` voxels (at most kFarthestReach).
LeafMask dilateBall(const Neighbourhood& around, double reach);

/// The middle leaf of the voxels that `seeds` reach in at most `steps` (1..kFarthestReach) steps over faces, edges and
/// corners through `open` (a geodesic dilation). Seeds count as reached, open or not.
LeafMask spreadThrough(const Neighbourhood& open, const Neighbourhood& seeds, int steps);

/// The bits of `open` that `seeds` reach through `open` over faces, inside one leaf. `seeds` outside `open` are
/// dropped.
LeafMask floodWithin(const LeafMask& open, const LeafMask& seeds);

}  // namespace stratum::voxelize
