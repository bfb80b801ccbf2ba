// Which leaves of a print are one process's own, where several make one level set.
#pragma once

#include "base/shard.h"
#include "voxelize/grid/leaf_stream.h"

namespace stratum::voxelize {

/// Blocks that lie one behind the other in the file, and what they have at most.
struct LeafShare {
    BlockRange blocks;
    NodeBounds bounds;
};

/// The shares of all shards are all blocks, in their order. Each has about the same bound of leaves, as well as whole
/// blocks allow; some are empty if there are more shards than blocks.
LeafShare shareOf(const PlanBins& bins, const LeafBounds& bounds, const Shard& shard);

}  // namespace stratum::voxelize
