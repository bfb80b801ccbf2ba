#include "voxelize/grid/leaf_share.h"

#include "voxelize/grid/leaf_blocks.h"

#include <algorithm>

namespace stratum::voxelize {
namespace {

std::size_t mostLeaves(const LeafBlock& block, const PlanBins& bins, const LeafBounds& bounds) {
    std::size_t leaves = 0;
    forEachColumnOf(block, bins, [&](std::size_t bin, std::size_t) { leaves += leavesIn(block, bounds.columns[bin]); });
    return leaves;
}

}  // namespace

LeafShare shareOf(const PlanBins& bins, const LeafBounds& bounds, const Shard& shard) {
    std::size_t all = 0;
    forEachBlock(bins, bounds, [&](std::size_t, const LeafBlock& block) { all += mostLeaves(block, bins, bounds); });
    const auto index = static_cast<std::size_t>(shard.index);
    const auto count = static_cast<std::size_t>(shard.count);
    LeafShare share{{0, 0}, {}};
    std::size_t before = 0;
    forEachBlock(bins, bounds, [&](std::size_t number, const LeafBlock& block) {
        const std::size_t leaves = mostLeaves(block, bins, bounds);
        // A block is of the shard in whose part of the leaves its middle lies.
        const std::size_t owner = all == 0 ? 0 : std::min((2 * before + leaves) * count / (2 * all), count - 1);
        before += leaves;
        if (leaves == 0 || owner != index) return;
        if (share.bounds.leaves == 0) share.blocks.first = number;
        share.blocks.end = number + 1;
        share.bounds.leaves += leaves;
        share.bounds.lower_nodes += cellsMet(block.first_k, block.last_k, kBlockLeaves);
        share.bounds.upper_nodes += 1;
    });
    share.bounds.upper_nodes = std::min(share.bounds.upper_nodes, bounds.upper_nodes);
    return share;
}

}  // namespace stratum::voxelize
