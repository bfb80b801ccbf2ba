#include "voxelize/grid/interior_distance.h"

#include "base/parallel_for.h"

#include <openvdb/tools/FastSweeping.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tree/LeafManager.h>
#include <tbb/task_group.h>

#include <functional>
#include <stop_token>

namespace stratum::voxelize {
namespace {

using Sweeping = openvdb::tools::FastSweeping<openvdb::FloatGrid>;

// OpenVDB's loops don't ask whether they shall stop, but they run in the caller's group of TBB, which can be cancelled:
// the loop that runs then ends, and those after it do nothing. What is left of the grid is thrown away, and so is what
// OpenVDB says of it.
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

void sweep(Sweeping& sweeping, const openvdb::FloatGrid& grid) {
#ifdef NDEBUG
    stoppable([&] {
        if (sweeping.initSdf(grid, 0, true)) sweeping.sweep();
    });
#else
    // Between the loops of the preparations is an assertion, which what a cancelled loop leaves would break.
    if (sweeping.initSdf(grid, 0, true)) stoppable([&] { sweeping.sweep(); });
#endif
}

}  // namespace

void sweepInterior(openvdb::FloatGrid& grid) {
    const float background = grid.background();
    Sweeping sweeping;
    sweep(sweeping, grid);
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
