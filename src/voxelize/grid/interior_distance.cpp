#include "voxelize/grid/interior_distance.h"

#include "base/memory.h"
#include "base/parallel_for.h"

#include <openvdb/tools/FastSweeping.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tree/LeafManager.h>
#include <tbb/task_group.h>

#include <functional>
#include <memory>
#include <stop_token>
#include <utility>
#include <vector>

namespace stratum::voxelize {
namespace {

using UpperNode = openvdb::FloatTree::RootNodeType::ChildNodeType;
using LowerNode = UpperNode::ChildNodeType;

// A copy that stops between nodes of 128^3 voxels: most of the preparation's time is that of its memory.
openvdb::FloatTree::Ptr copyOf(const openvdb::FloatTree& tree) {
    auto copy = std::make_shared<openvdb::FloatTree>(tree.background());
    for (auto tile = tree.root().cbeginValueAll(); tile; ++tile)
        copy->root().addTile(tile.getCoord(), *tile, tile.isValueOn());
    std::vector<std::pair<UpperNode*, const LowerNode*>> places;
    for (auto child = tree.root().cbeginChildOn(); child; ++child) {
        auto upper = std::make_unique<UpperNode>(child->origin(), tree.background());
        for (auto tile = child->cbeginValueAll(); tile; ++tile) upper->addTile(tile.pos(), *tile, tile.isValueOn());
        for (auto lower = child->cbeginChildOn(); lower; ++lower) places.emplace_back(upper.get(), &*lower);
        copy->root().addChild(upper.release());
    }
    std::vector<std::unique_ptr<LowerNode>> nodes(places.size());
    parallelFor(places.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t n = first; n != last; ++n) nodes[n] = std::make_unique<LowerNode>(*places[n].second);
    });
    for (std::size_t n = 0; n != places.size(); ++n) places[n].first->addChild(nodes[n].release());
    return copy;
}

// A level set that asks whether the work shall stop. FastSweeping's preparations may not be cancelled from outside:
// what a cancelled loop leaves of a tree has null pointers, which clearing it follows. Its copy stops by itself. Its
// masks and buffers can't be stopped. Its long loop, over the values, asks for the voxel size every 32 leaves; so does
// the start of each sweep.
class StoppableGrid : public openvdb::FloatGrid {
public:
    using Ptr = std::shared_ptr<StoppableGrid>;
    using ConstPtr = std::shared_ptr<const StoppableGrid>;

    /// Shares the tree.
    StoppableGrid(openvdb::FloatGrid& grid, const std::stop_token* stop)
        : openvdb::FloatGrid(grid.treePtr()), stop_(stop) {
        setTransform(grid.transformPtr());
    }
    Ptr deepCopy() const {
        const openvdb::FloatGrid::Ptr copy = copyWithNewTree();
        copy->setTree(copyOf(tree()));
        return std::make_shared<StoppableGrid>(*copy, stop_);
    }
    openvdb::Vec3d voxelSize() const {
        ask();
        return openvdb::FloatGrid::voxelSize();
    }

private:
    // By the token, since TBB's threads have no StopScope of ours.
    void ask() const {
        if (stop_ != nullptr && stop_->stop_requested()) throw Stopped();
    }

    const std::stop_token* stop_;
};

using Sweeping = openvdb::tools::FastSweeping<StoppableGrid>;

// The sweeps run in the caller's group of TBB, which can be cancelled: the loop that runs then ends, and those after it
// do nothing. What is left of the grid is thrown away, and so is what OpenVDB says of it.
void stoppable(const std::function<void()>& work) {
    const std::stop_token* const stop = StopScope::current();
    if (stop == nullptr) return work();
    tbb::task_group_context context;
    tbb::task_group group(context);
    const std::stop_callback cancel(*stop, [&context] { context.cancel_group_execution(); });
    try {
        group.run_and_wait(work);
    } catch (const openvdb::Exception&) {
        stopIfAsked();
        throw;
    }
    stopIfAsked();
}

}  // namespace

void sweepInterior(openvdb::FloatGrid& grid) {
    requireMemory(kSweepBytesPerLeaf * grid.tree().leafCount(), "a sweep of the distances inside",
                  "choose a larger voxel, or leave out --interior-distance");
    const float background = grid.background();
    Sweeping sweeping;
    if (sweeping.initSdf(StoppableGrid(grid, StopScope::current()), 0, true))
        stoppable([&sweeping] { sweeping.sweep(); });
    const openvdb::FloatGrid::Ptr swept = sweeping.sdfGrid();
    const openvdb::tree::LeafManager<openvdb::FloatTree> leaves(grid.tree());
    parallelFor(leaves.leafCount(), 64, [&](std::size_t first, std::size_t last) {
        for (std::size_t n = first; n != last; ++n) {
            auto& leaf = leaves.leaf(n);
            const auto* other = swept->tree().probeConstLeaf(leaf.origin());
            if (other == nullptr) continue;
            for (auto voxel = leaf.beginValueOn(); voxel; ++voxel) {
                if (*voxel >= 0) continue;
                const float value = other->getValue(voxel.pos());
                // The sweep must not change signs: a zero crossing that rounds to the other side keeps its sign.
                voxel.setValue(value < 0 ? std::max(value, -background) : *voxel);
                if (*voxel <= -background) voxel.setValueOff();
            }
        }
    });
    openvdb::tools::pruneLevelSet(grid.tree());
}

}  // namespace stratum::voxelize
