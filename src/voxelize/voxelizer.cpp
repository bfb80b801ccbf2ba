#include "voxelize/voxelizer.h"

#include "io/error.h"
#include "parallel/parallel_for.h"
#include "voxelize/estimate.h"
#include "voxelize/layer_stack.h"
#include "voxelize/leaf_column.h"
#include "voxelize/plan_bins.h"

#include <fmt/format.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tree/LeafManager.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <mutex>
#include <string>
#include <vector>

namespace stratum::voxelize {
namespace {

// A leaf's values, mask and header, and its share of the nodes above.
constexpr double kBytesPerLeaf = 2048 + 64 + 64 + 32;

std::size_t availableMemory() {
    std::ifstream meminfo("/proc/meminfo");
    std::string key;
    std::size_t kilobytes = 0;
    std::string unit;
    while (meminfo >> key >> kilobytes >> unit)
        if (key == "MemAvailable:") return kilobytes * 1024 / 10 * 9;
    return std::size_t{4} << 30;
}

// Calls back at most once a percent, one thread at a time.
class ProgressMeter {
public:
    ProgressMeter(std::size_t total, const std::function<void(double)>& report) : total_(total), report_(report) {}
    void advance(std::size_t count) {
        if (!report_) return;
        const std::size_t done = done_.fetch_add(count, std::memory_order_relaxed) + count;
        if (done * 100 / total_ == (done - count) * 100 / total_) return;
        const std::scoped_lock lock(mutex_);
        report_(static_cast<double>(done) / static_cast<double>(total_));
    }

private:
    const std::size_t total_;
    const std::function<void(double)>& report_;
    std::atomic<std::size_t> done_{0};
    std::mutex mutex_;
};

// What one column contributes to the grid. Leaves are owned by whoever takes them over.
struct ColumnLeaves {
    std::vector<Leaf*> leaves;
    std::vector<openvdb::Coord> inside_tiles;  // origins of leaf positions that are deep inside
};

openvdb::math::Transform::Ptr makeTransform(const Lattice& lattice, const Placement& placement) {
    auto transform = openvdb::math::Transform::createLinearTransform(lattice.voxel_size * placement.unit);
    transform->postTranslate(openvdb::Vec3d(placement.offset[0] * placement.unit, placement.offset[1] * placement.unit,
                                            (placement.offset[2] + lattice.origin_z) * placement.unit));
    return transform;
}

}  // namespace

openvdb::FloatGrid::Ptr voxelize(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                                 const Lattice& lattice, const VoxelizeOptions& options) {
    const std::size_t limit = options.memory_limit != 0 ? options.memory_limit : availableMemory();
    // Only what is hopeless is refused here, for the estimate can be off; the exact bound follows from the bins.
    const double estimate =
        estimateActiveVoxels(toolpath, selection, lattice.voxel_size, lattice.half_width) * kBytesPerActiveVoxel;
    if (estimate > 3 * static_cast<double>(limit))
        throw UsageError(fmt::format(
            "voxel size {:g} mm needs about {:.3g} GB, {:.3g} GB are free; choose a larger voxel "
            "(half the layer height is {:g} mm), fewer layers or features",
            lattice.voxel_size, estimate * 1e-9, static_cast<double>(limit) * 1e-9, lattice.layer_height / 2));
    const LayerStack stack = stackLayers(toolpath, selection);
    const PlanBins bins(toolpath, stack, lattice, limit / 4);
    const double scale = options.placement.unit;

    tbb::enumerable_thread_specific<LeafColumn> scratch([&] { return LeafColumn(toolpath, stack, lattice, scale); });
    constexpr std::size_t kGrain = 16;  // columns
    std::atomic<std::size_t> leaf_bound{0};
    parallelFor(bins.size(), kGrain, [&](std::size_t first, std::size_t last) {
        LeafColumn& column = scratch.local();
        std::size_t count = 0;
        for (std::size_t c = first; c != last; ++c)
            if (!bins[c].empty()) count += column.countLeaves(bins[c]);
        leaf_bound.fetch_add(count, std::memory_order_relaxed);
    });
    const double bytes = static_cast<double>(leaf_bound.load()) * kBytesPerLeaf;
    if (bytes > static_cast<double>(limit))
        throw UsageError(fmt::format(
            "voxel size {:g} mm needs up to {:.1f} GB ({:.3g} leaves), {:.1f} GB are free; choose a larger voxel, "
            "fewer "
            "layers or features",
            lattice.voxel_size, bytes * 1e-9, static_cast<double>(leaf_bound.load()),
            static_cast<double>(limit) * 1e-9));

    std::vector<ColumnLeaves> built(bins.size());
    ProgressMeter meter(std::max<std::size_t>(bins.entryCount(), 1), options.progress);
    parallelFor(bins.size(), kGrain, [&](std::size_t first, std::size_t last) {
        LeafColumn& column = scratch.local();
        for (std::size_t c = first; c != last; ++c) {
            if (bins[c].empty()) continue;
            column.open(bins.originI(c), bins.originJ(c), bins[c], std::numeric_limits<std::uint32_t>::max());
            for (const LeafRange& range : column.touched())
                for (int k = range.first; k <= range.second; ++k) {
                    const LeafContent content = column.evaluate(k);
                    if (content == LeafContent::surface) built[c].leaves.push_back(column.makeLeaf());
                    if (content == LeafContent::inside)
                        built[c].inside_tiles.push_back(
                            openvdb::Coord(bins.originI(c), bins.originJ(c), k * kLeafDim));
                }
            meter.advance(bins[c].size());
        }
    });

    const auto background = static_cast<float>(lattice.background() * scale);
    auto grid = openvdb::FloatGrid::create(background);
    auto accessor = grid->getAccessor();
    for (ColumnLeaves& column : built) {
        for (Leaf* leaf : column.leaves) accessor.addLeaf(leaf);
        for (const openvdb::Coord& origin : column.inside_tiles) accessor.addTile(1, origin, -background, false);
    }
    openvdb::tools::pruneLevelSet(grid->tree());
    grid->setTransform(makeTransform(lattice, options.placement));
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    grid->setName("surface");
    return grid;
}

double enclosedVolume(const openvdb::FloatGrid& grid) {
    const double voxel = grid.voxelSize()[0];
    const openvdb::tree::LeafManager<const openvdb::FloatTree> leaves(grid.tree());
    // One sum a leaf, added in order: the same value for any number of threads.
    std::vector<double> sums(leaves.leafCount());
    parallelFor(sums.size(), 64, [&](std::size_t first, std::size_t last) {
        for (std::size_t n = first; n != last; ++n) {
            const float* values = leaves.leaf(n).buffer().data();
            for (openvdb::Index v = 0; v < Leaf::SIZE; ++v)
                sums[n] += std::clamp(0.5 - static_cast<double>(values[v]) / voxel, 0.0, 1.0);
        }
    });
    double voxels = 0;
    for (const double sum : sums) voxels += sum;
    for (auto tile = grid.tree().cbeginValueOff(); tile; ++tile)
        if (tile.getLevel() > 0 && *tile < 0) voxels += static_cast<double>(tile.getVoxelCount());
    return voxels * voxel * voxel * voxel;
}

}  // namespace stratum::voxelize
