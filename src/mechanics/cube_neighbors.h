// Which cubes of a list share a face.
#pragma once

#include "mechanics/cube_shares.h"

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace stratum::mechanics {

constexpr std::uint32_t kNoCube = std::numeric_limits<std::uint32_t>::max();

/// By CubeSide: the index of the neighbour, or kNoCube.
using CubeNeighbors = std::array<std::uint32_t, kCubeSides>;

/// Of cubes by k, then j, then i; any record with these members.
template <typename Cube>
std::vector<CubeNeighbors> cubeNeighbors(const std::vector<Cube>& list) {
    CubeNeighbors none;
    none.fill(kNoCube);
    std::vector<CubeNeighbors> neighbors(list.size(), none);
    const auto place = [](const Cube& cube, int di, int dj, int dk) {
        return std::array<std::int32_t, 3>{cube.k + dk, cube.j + dj, cube.i + di};
    };
    for (const CubeSide side : {x_high, y_high, z_high}) {
        // Two fingers go up the list.
        std::uint32_t other = 0;
        for (std::uint32_t n = 0; n < list.size(); ++n) {
            const auto wanted = place(list[n], side == x_high, side == y_high, side == z_high);
            while (other < list.size() && place(list[other], 0, 0, 0) < wanted) ++other;
            if (other == list.size()) break;
            if (place(list[other], 0, 0, 0) != wanted) continue;
            neighbors[n][side] = other;
            neighbors[other][side ^ 1] = n;
        }
    }
    return neighbors;
}

}  // namespace stratum::mechanics
