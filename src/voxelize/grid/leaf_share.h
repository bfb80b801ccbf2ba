// Which blocks of a print are one process's own, where several make one level set.
#pragma once

#include "base/shard.h"
#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/lattice.h"
#include "voxelize/beads/layer_stack.h"
#include "voxelize/beads/plan_tiles.h"

#include <cstddef>

namespace stratum::voxelize {

/// Blocks of LeafReceiver that lie one behind the other, by their number among all of the print's rectangle.
struct BlockRange {
    std::size_t first = 0, end = static_cast<std::size_t>(-1);
    bool has(std::size_t number) const { return number >= first && number < end; }
    bool operator==(const BlockRange&) const = default;
};

struct LeafShare {
    BlockRange blocks;
    PlanTiles tiles;  ///< of these blocks, with their heights, for PlanBins
};

/// The shares of all shards are all blocks, in their order. Each has about the same number of entries of PlanBins, by a
/// bound from the beads alone and as well as whole blocks allow; some are empty if there are more shards than blocks.
/// The stack is not empty. Parallel; the result does not depend on the number of threads.
LeafShare shareOf(const gcode::Toolpath& toolpath, const LayerStack& stack, const Lattice& lattice, const Shard& shard);

}  // namespace stratum::voxelize
