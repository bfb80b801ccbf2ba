#include "mechanics/solid_elements.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/parallel_for.h"
#include "voxelize/beads/layer_stack.h"
#include "voxelize/beads/plan_bins.h"
#include "voxelize/grid/progress_meter.h"
#include "voxelize/grid/solid_check.h"
#include "voxelize/leaf/leaf_column.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <tuple>

namespace stratum::mechanics {
namespace {

using voxelize::kLeafDim;
using voxelize::LeafContent;

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// Samples in the middle of cubes: half a voxel above the planes of layers. With one voxel a layer or fewer the lattice
// has them there already.
voxelize::Lattice middlesOf(const voxelize::Lattice& lattice) {
    voxelize::Lattice middles = lattice;
    const double per_layer = lattice.layer_height / lattice.voxel_size;
    if (per_layer > 1.01) middles.origin_z += 0.5 * lattice.voxel_size;
    // Owners are known within the band: it must reach the middle of every bead.
    middles.half_width = std::max(3.0, 0.5 * per_layer + 2);
    return middles;
}

[[noreturn]] void refuse(double count, const SolidOptions& options, double edge) {
    // The number falls with the cube of the size; a tenth more for what that leaves out.
    const double fits = edge * std::cbrt(1.1 * count / static_cast<double>(options.most));
    throw UsageError(
        fmt::format("about {:.3g} elements of {:g} mm are more than the {} nodes that are allowed; choose --voxel-size "
                    "{:.2g} or more, fewer layers or features, or a higher --max-nodes",
                    count, edge, options.most, std::ceil(fits * 100) / 100));
}

// The solid voxels of one leaf column, from the lowest leaf.
class ColumnReader {
public:
    ColumnReader(voxelize::LeafColumn& column, const voxelize::LayerStack& stack) : column_(column), stack_(stack) {}

    void read(int i, int j, std::span<const std::uint32_t> ranks, std::vector<SolidElement>& out) {
        column_.open(i, j, ranks, kNone);
        std::array<std::uint32_t, voxelize::Leaf::SIZE> owners;
        for (const voxelize::LeafRange& range : column_.touched())
            for (int k = range.first; k <= range.second; ++k) {
                if (column_.evaluate(k) == LeafContent::outside) continue;
                column_.owners(owners);
                take(i, j, k * kLeafDim, owners, out);
            }
    }

private:
    void take(int i, int j, int k, std::span<const std::uint32_t> owners, std::vector<SolidElement>& out) const {
        const voxelize::LeafPlanes& phi = column_.planes();
        for (int z = 0; z < kLeafDim; ++z)
            for (int x = 0; x < kLeafDim; ++x)
                for (int y = 0; y < kLeafDim; ++y) {
                    const std::size_t at = static_cast<std::size_t>(x) * kLeafDim + static_cast<std::size_t>(y);
                    if (!(phi.plane[z].v[at] < 0)) continue;
                    const std::uint32_t rank = owners[at * kLeafDim + static_cast<std::size_t>(z)];
                    // Inside, and yet no bead within the band: only where welds reach deeper than beads.
                    if (rank == kNone) continue;
                    out.push_back({i + x, j + y, k + z, stack_.beads[rank]});
                }
    }

    voxelize::LeafColumn& column_;
    const voxelize::LayerStack& stack_;
};

// By k, then j, then i: into the planes first, which many threads then order.
std::vector<SolidElement> ordered(const std::vector<std::vector<SolidElement>>& columns, std::size_t count) {
    int low = std::numeric_limits<int>::max();
    int high = std::numeric_limits<int>::min();
    for (const auto& column : columns)
        for (const SolidElement& e : column) {
            low = std::min(low, e.k);
            high = std::max(high, e.k);
        }
    std::vector<SolidElement> all(count);
    if (count == 0) return all;
    const auto planes = static_cast<std::size_t>(high - low) + 1;
    std::vector<std::size_t> first(planes + 1);
    for (const auto& column : columns)
        for (const SolidElement& e : column) ++first[static_cast<std::size_t>(e.k - low) + 1];
    for (std::size_t p = 0; p < planes; ++p) first[p + 1] += first[p];
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for (const auto& column : columns)
        for (const SolidElement& e : column) all[next[static_cast<std::size_t>(e.k - low)]++] = e;
    parallelFor(planes, 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t p = from; p < to; ++p)
            std::sort(
                all.begin() + static_cast<std::ptrdiff_t>(first[p]),
                all.begin() + static_cast<std::ptrdiff_t>(first[p + 1]),
                [](const SolidElement& a, const SolidElement& b) { return std::tie(a.j, a.i) < std::tie(b.j, b.i); });
    });
    return all;
}

}  // namespace

SolidElements solidElements(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                            const voxelize::Lattice& lattice, const SolidOptions& options) {
    const double edge = lattice.voxel_size;
    if (lattice.layer_height / edge > kMostPerLayer)
        throw UsageError(
            fmt::format("elements of {:g} mm are less than a {:g}th of a layer of {:g} mm; choose --voxel-size "
                        "{:.2g} or more",
                        edge, kMostPerLayer, lattice.layer_height, lattice.layer_height / kMostPerLayer));
    // Beads overlap: the solid is less than what they hold, but not much.
    const double expected = voxelize::depositedVolume(toolpath, selection) / (edge * edge * edge);
    if (options.most > 0 && expected > 2.0 * static_cast<double>(options.most)) refuse(expected, options, edge);

    const voxelize::Lattice middles = middlesOf(lattice);
    const voxelize::LayerStack stack = voxelize::stackLayers(toolpath, selection);
    const voxelize::PlanBins bins(toolpath, stack, middles, availableMemory() / 4);
    tbb::enumerable_thread_specific<voxelize::LeafColumn> scratch(
        [&] { return voxelize::LeafColumn(toolpath, stack, middles, 1.0, true); });
    voxelize::ProgressMeter meter(std::max<std::size_t>(bins.entryCount(), 1), options.progress);
    std::vector<std::vector<SolidElement>> columns(bins.size());
    std::atomic<std::size_t> count{0};
    parallelFor(bins.size(), 16, [&](std::size_t first, std::size_t last) {
        ColumnReader reader(scratch.local(), stack);
        for (std::size_t c = first; c < last; ++c) {
            if (bins[c].empty()) continue;
            // Columns come in any order, so what is refused must not depend on which came first: only whether.
            if (options.most > 0 && count.load(std::memory_order_relaxed) > options.most) return;
            reader.read(bins.originI(c), bins.originJ(c), bins[c], columns[c]);
            count.fetch_add(columns[c].size(), std::memory_order_relaxed);
            meter.advance(bins[c].size());
        }
    });
    if (options.most > 0 && count > options.most)
        refuse(std::max(expected, static_cast<double>(options.most)), options, edge);

    SolidElements elements;
    elements.edge = edge;
    elements.origin[0] = elements.origin[1] = -0.5 * edge;
    elements.origin[2] = middles.origin_z - 0.5 * edge;
    elements.list = ordered(columns, count);
    return elements;
}

}  // namespace stratum::mechanics
