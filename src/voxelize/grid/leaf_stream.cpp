#include "voxelize/grid/leaf_stream.h"

#include "base/parallel_for.h"
#include "base/progress_meter.h"
#include "voxelize/grid/solid_check.h"
#include "voxelize/swell/swell_field.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <vector>

namespace stratum::voxelize {
namespace {

constexpr std::size_t kBoundGrain = 16;  // columns

// Makes the leaves of one block after the other.
class Blocks {
public:
    Blocks(const PrintColumns& columns, std::uint32_t end, const LeafBounds& bounds, LeafReceiver& receiver,
           bool measure, std::size_t entries, const std::function<void(double)>& progress)
        : columns_(columns),
          bins_(columns.bins()),
          end_(end),
          bounds_(bounds),
          receiver_(receiver),
          measure_(measure),
          meter_(std::max<std::size_t>(entries, 1), progress) {}

    void run(const LeafBlock& block) {
        std::vector<Column> columns;
        for (std::size_t bin = block.columns->first; bin < block.columns->last; ++bin)
            if (leavesIn(block.heights, bounds_.columns[bin]) > 0) columns.push_back({bin, placeInBlock(bins_, bin)});
        if (columns.empty()) return;
        std::sort(columns.begin(), columns.end(), [](const Column& a, const Column& b) { return a.place < b.place; });
        if (columns_.stack().swell != nullptr) makeSwell(columns);
        receiver_.open(block.origin());
        // Output of the block before is one more item.
        parallelFor(columns.size() + 1, 1, [&](std::size_t first, std::size_t last) {
            for (std::size_t n = first; n < last; ++n) {
                if (n == 0) {
                    receiver_.workOnClosed();
                    continue;
                }
                Column& column = columns[n - 1];
                make(column, block.heights);
            }
        });
        receiver_.close();
        for (const Column& column : columns) {
            inside_leaves_ += column.inside;
            sampled_voxels_ += column.sampled_voxels;
            report_.measured += column.sampled;
            report_.evaluated += column.evaluated;
            report_.leaves += column.leaves;
        }
    }

    LeafStreamReport report() const {
        LeafStreamReport report = report_;
        if (report.measured > 0)
            report.volume_voxels =
                sampled_voxels_ * static_cast<double>(report.leaves) / static_cast<double>(report.measured);
        report.volume_voxels += static_cast<double>(inside_leaves_) * Leaf::SIZE;
        return report;
    }

private:
    // One column of the block; what was found there is added in the order of the columns.
    struct Column {
        std::size_t bin, place;
        std::size_t evaluated = 0, leaves = 0, sampled = 0;
        std::size_t inside = 0;  // leaf positions that are all inside
        double sampled_voxels = 0;
    };

    // Before all threads go up through the same few tiles.
    void makeSwell(const std::vector<Column>& columns) const {
        const LayerStack& stack = columns_.stack();
        const auto node = [voxel = columns_.lattice().voxel_size, spacing = nodeSpacing(stack)](double index) {
            return static_cast<int>(std::floor(index * voxel / spacing));
        };
        NodeBox nodes;
        std::uint32_t first = std::numeric_limits<std::uint32_t>::max();
        std::uint32_t last = 0;
        for (const Column& column : columns) {
            const std::span<const std::uint32_t> ranks = bins_[column.bin];
            const auto direct = std::lower_bound(ranks.begin(), ranks.end(), stack.first_direct);
            if (direct == ranks.begin()) continue;
            first = std::min(first, stack.layer[ranks.front()]);
            last = std::max(last, stack.layer[*(direct - 1)]);
            const double i = bins_.originI(column.bin);
            const double j = bins_.originJ(column.bin);
            nodes = nodes.with({node(i), node(i + kLeafDim - 1) + 2, node(j), node(j + kLeafDim - 1) + 2});
        }
        if (first <= last) stack.swell->makeTiles(columns_.toolpath(), stack, nodes, first, last);
    }

    void make(Column& to, const LeafRange& heights) {
        LeafColumn& column = columns_.open(to.bin, end_);
        const int i = bins_.originI(to.bin);
        const int j = bins_.originJ(to.bin);
        std::array<float, Leaf::SIZE> values;
        std::array<std::uint64_t, 8> active;
        for (const LeafRange& range : column.touched())
            for (int k = std::max(range.first, heights.first); k <= std::min(range.second, heights.second); ++k) {
                ++to.evaluated;
                const LeafContent content = column.evaluate(k);
                if (content == LeafContent::inside) ++to.inside;
                if (content != LeafContent::surface) continue;
                column.storeValues(values, active);
                receiver_.leaf(to.place, {i, j, k * kLeafDim}, values.data(), active.data());
                ++to.leaves;
                if (!measure_ || !takes(to.bin, k)) continue;
                column.evaluate(k, kMostPlanes);
                ++to.sampled;
                to.sampled_voxels += insideOf(column.planes());
            }
        if (bounds_.columns[to.bin].second <= heights.second) meter_.advance(bins_[to.bin].size());
    }

    bool takes(std::size_t bin, int k) const {
        const ColumnRange& all = bins_.rectangle();
        const auto row = static_cast<std::uint64_t>(bins_.columnJ(bin) - all.j0);
        const std::uint64_t in_plan = row * static_cast<std::uint64_t>(all.i1 - all.i0 + 1) +
                                      static_cast<std::uint64_t>(bins_.columnI(bin) - all.i0);
        const std::uint64_t place = in_plan << 24 ^ static_cast<std::uint32_t>(k);
        return bounds_.leaves <= kVolumeSample || scattered(place) % bounds_.leaves < kVolumeSample;
    }

    static double insideOf(const LeafPlanes& phi) {
        LeafSamples samples{};
        for (int x = 0; x < kLeafDim; ++x)
            for (int y = 0; y < kLeafDim; ++y)
                for (std::size_t z = 0; z < kMostPlanes; ++z) samples.v[x][y][z] = phi.plane[z].v[x * kLeafDim + y];
        constexpr int kOwn = kLeafDim - 1;  // cells along x and y that need no other column
        return insideCells(samples, kOwn) * (kLeafDim * kLeafDim) / (kOwn * kOwn);
    }

    const PrintColumns& columns_;
    const PlanBins& bins_;
    const std::uint32_t end_;
    const LeafBounds& bounds_;
    LeafReceiver& receiver_;
    const bool measure_;
    ProgressMeter meter_;
    LeafStreamReport report_;
    std::size_t inside_leaves_ = 0;
    double sampled_voxels_ = 0;
};

}  // namespace

LeafBounds boundLeaves(const PrintColumns& columns, const LeafRange& heights) {
    const PlanBins& bins = columns.bins();
    LeafBounds all;
    constexpr LeafRange kNone{std::numeric_limits<int>::max(), std::numeric_limits<int>::min()};
    if (bins.size() == 0) return all;
    const std::vector<LeafRange> slabs = slabsOf(heights);
    const int low = floorDivide(heights.first, kBlockLeaves);
    const std::size_t high = cellsMet(heights.first, heights.second, kBlockLeaves);
    std::vector<std::atomic<bool>> lower(bins.blocks().size() * high);  // nodes with leaves
    all.columns.assign(bins.size(), kNone);
    std::atomic<std::size_t> leaves{0};
    parallelFor(bins.size(), kBoundGrain, [&](std::size_t first, std::size_t last) {
        std::size_t count = 0;
        for (std::size_t c = first; c != last; ++c) {
            const std::size_t block = bins.blockOf(c);
            const std::span<const LeafRange> ranges = columns.bounds(c);
            for (const LeafRange& slab : slabs)
                for (const LeafRange& range : ranges) {
                    const std::size_t leaves_here = leavesIn(slab, range);
                    if (leaves_here == 0) continue;
                    count += leaves_here;
                    const int last = floorDivide(std::min(range.second, slab.second), kBlockLeaves);
                    for (int k = floorDivide(std::max(range.first, slab.first), kBlockLeaves); k <= last; ++k)
                        lower[block * high + static_cast<std::size_t>(k - low)].store(true, std::memory_order_relaxed);
                }
            all.columns[c] = {ranges.front().first, ranges.back().second};
        }
        leaves.fetch_add(count, std::memory_order_relaxed);
    });
    all.leaves = leaves;
    all.heights = heights;
    all.lower_nodes = static_cast<std::size_t>(std::count(lower.begin(), lower.end(), true));
    std::size_t uppers = 0;
    forEachUpper(bins, [&](std::size_t, std::size_t) { uppers += slabs.size(); });
    all.upper_nodes = std::min(uppers, all.lower_nodes);
    return all;
}

LeafStreamReport streamLeaves(const PrintColumns& columns, std::uint32_t end, const LeafBounds& bounds,
                              LeafReceiver& receiver, bool measure, const std::function<void(double)>& progress) {
    const PlanBins& bins = columns.bins();
    if (bounds.leaves == 0) return {};
    std::size_t entries = 0;
    forEachBlock(bins, bounds.heights, [&](const LeafBlock& block) {
        for (std::size_t bin = block.columns->first; bin < block.columns->last; ++bin) {
            const LeafRange& column = bounds.columns[bin];
            if (leavesIn(block.heights, column) > 0 && column.second <= block.heights.second)
                entries += bins[bin].size();
        }
    });
    Blocks blocks(columns, end, bounds, receiver, measure, entries, progress);
    forEachBlock(bins, bounds.heights, [&](const LeafBlock& block) { blocks.run(block); });
    return blocks.report();
}

}  // namespace stratum::voxelize
