#include "mechanics/cube_beads.h"

#include "base/memory.h"
#include "base/parallel_for.h"
#include "voxelize/beads/layer_stack.h"
#include "voxelize/leaf/print_columns.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <tuple>
#include <vector>

namespace stratum::mechanics {
namespace {

using voxelize::kLeafDim;

constexpr std::uint32_t kNobody = std::numeric_limits<std::uint32_t>::max();

// Samples in the middles of cubes.
voxelize::Lattice middlesOf(const gcode::Toolpath& toolpath, const voxelize::LayerStack& stack,
                            const voxelize::Lattice& lattice, const SolidElements& elements) {
    voxelize::Lattice middles = lattice;
    middles.origin_z = elements.origin[2] + 0.5 * elements.edge;
    // Owners are known within the band: it must reach the middle of every bead, and plastic in a cube's corner.
    double thickest = 0;
    for (const voxelize::Layer& layer : stack.layers) thickest = std::max(thickest, layer.halfHeight());
    for (const std::uint32_t bead : stack.direct())
        thickest = std::max(thickest, voxelize::sectionOf(toolpath, toolpath.beads[bead]).halfHeight());
    middles.half_width = std::max(3.0, thickest / elements.edge + 2);
    return middles;
}

// A shift rounds down, also below 0.
constexpr int kLeafBits = 3;
static_assert(kLeafDim == 1 << kLeafBits);

}  // namespace

void setBeads(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
              const voxelize::Lattice& lattice, SolidElements& elements) {
    const voxelize::LayerStack stack = voxelize::stackLayers(toolpath, selection);
    const voxelize::Lattice middles = middlesOf(toolpath, stack, lattice, elements);
    const voxelize::PrintColumns columns(toolpath, stack, middles, 1, voxelize::LeafColumn::Kind::values,
                                         availableMemory());
    if (columns.size() == 0 || elements.list.empty()) return;
    std::vector<SolidElement>& list = elements.list;

    // By column of leaves, from the bottom.
    std::vector<std::uint32_t> order(list.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto leaf = [&list](std::uint32_t n) {
        return std::tuple(list[n].j >> kLeafBits, list[n].i >> kLeafBits, list[n].k >> kLeafBits);
    };
    tbb::parallel_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return std::tuple_cat(leaf(a), std::tuple(a)) < std::tuple_cat(leaf(b), std::tuple(b));
    });
    const auto same_column = [&leaf](std::uint32_t a, std::uint32_t b) {
        return std::get<0>(leaf(a)) == std::get<0>(leaf(b)) && std::get<1>(leaf(a)) == std::get<1>(leaf(b));
    };
    std::vector<std::size_t> first;
    for (std::size_t n = 0; n < order.size(); ++n)
        if (n == 0 || !same_column(order[n], order[n - 1])) first.push_back(n);
    first.push_back(order.size());

    parallelFor(first.size() - 1, 16, [&](std::size_t begin, std::size_t end) {
        std::array<std::uint32_t, voxelize::Leaf::SIZE> owners;
        for (std::size_t c = begin; c < end; ++c) {
            const int i = list[order[first[c]]].i >> kLeafBits << kLeafBits;
            const int j = list[order[first[c]]].j >> kLeafBits << kLeafBits;
            const std::size_t bin = columns.bins().find(i >> kLeafBits, j >> kLeafBits);
            if (bin == voxelize::PlanBins::kNone) continue;
            voxelize::LeafColumn& column = columns.open(bin);
            int evaluated = std::numeric_limits<int>::min();
            for (std::size_t n = first[c]; n < first[c + 1]; ++n) {
                SolidElement& e = list[order[n]];
                if (e.k >> kLeafBits != evaluated) {
                    evaluated = e.k >> kLeafBits;
                    column.evaluate(evaluated);
                    column.owners(owners);
                }
                const int place = ((e.i - i) * kLeafDim + e.j - j) * kLeafDim + (e.k & (kLeafDim - 1));
                const std::uint32_t rank = owners[static_cast<std::size_t>(place)];
                if (rank != kNobody) e.bead = stack.beads[rank];
            }
        }
    });
}

}  // namespace stratum::mechanics
