// The swell of a tile from the sums around it.
#pragma once

#include "voxelize/beads/layer_stack.h"
#include "voxelize/swell/swell_field.h"

#include <array>

namespace stratum::voxelize {

/// The tiles of sums that a tile covers, and those around them, row by row from that before it along both axes.
struct SumsAround {
    static constexpr int kEdge = kTileCells / kSumCells + 2;
    static constexpr int kCount = kEdge * kEdge;
    std::array<const TileSums*, kCount> tiles{};

    const TileSums& at(int x, int y) const { return *tiles[nodeIndex(y, kEdge, x)]; }
};

/// Spreads the surplus of a tile's layers. `below`: the sums around the tile below, or null if there is none.
SwellTile spreadTile(const LayerStack& stack, TilePlace place, const SumsAround& around, const SumsAround* below);

}  // namespace stratum::voxelize
