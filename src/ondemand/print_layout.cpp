#include "ondemand/print_layout.h"

#include "base/memory.h"

#include <algorithm>
#include <utility>

namespace stratum::ondemand {
namespace {

using voxelize::kLeafDim;

double reachOf(const voxelize::LayerStack& stack, const voxelize::Lattice& lattice) {
    double thickest = 0;
    for (const voxelize::Layer& layer : stack.layers)
        thickest = std::max(thickest, layer.halfHeight() + layer.most_rise);
    return thickest * (1 + 2 * voxelize::kWeldGap) + lattice.background();
}

}  // namespace

PrintLayout::PrintLayout(std::shared_ptr<const gcode::Toolpath> the_toolpath, std::span<const std::uint32_t> selection,
                         const voxelize::Lattice& the_lattice, double the_unit)
    : toolpath(std::move(the_toolpath)),
      lattice(the_lattice),
      unit(the_unit),
      stack(voxelize::stackLayers(*toolpath, selection)),
      columns(*toolpath, stack, lattice, unit, voxelize::LeafColumn::Kind::values, availableMemory()),
      reach(reachOf(stack, lattice)) {}

std::optional<std::size_t> PrintLayout::columnOf(int i, int j) const {
    static_assert(kLeafDim == 8);
    const std::size_t column = columns.bins().find(i >> 3, j >> 3);
    if (column == voxelize::PlanBins::kNone) return std::nullopt;
    return column;
}

std::size_t PrintLayout::bytes() const {
    return columns.bins().bytes() + stack.extents.capacity() * sizeof(voxelize::Extent) +
           (stack.beads.capacity() + stack.layer.capacity()) * sizeof(std::uint32_t) +
           stack.layers.capacity() * sizeof(voxelize::Layer) + stack.welds.capacity() * sizeof(voxelize::Weld);
}

voxelize::LeafContent LeafMaker::make(const openvdb::Coord& origin, std::uint32_t end, std::size_t planes) {
    const auto column = layout_.columnOf(origin[0], origin[1]);
    if (!column) return voxelize::LeafContent::outside;
    const voxelize::LayerStack& stack = layout_.stack;
    const auto height = [this](int k) { return layout_.lattice.origin_z + k * layout_.lattice.voxel_size; };
    const double z_min = height(origin[2]);
    const double z_max = height(origin[2] + static_cast<int>(planes) - 1);
    // Ranks ascend with the layers' planes: the layers that reach this leaf are one interval. The column is opened for
    // these alone, not for its hundreds of layers.
    const auto below = [](const voxelize::Layer& layer, double z) { return layer.center_z < z; };
    const auto first = std::lower_bound(stack.layers.begin(), stack.layers.end(), z_min - layout_.reach, below);
    auto last = first;
    while (last != stack.layers.end() && last->center_z < z_max + layout_.reach) ++last;
    const std::span<const std::uint32_t> all = layout_.columns.bins()[*column];
    const std::uint32_t end_rank = stack.first_direct;
    const auto rankOf = [&](auto layer) { return layer != stack.layers.end() ? layer->first : end_rank; };
    const auto from =
        all.begin() + static_cast<std::ptrdiff_t>(voxelize::firstNotBelow(all, rankOf(first), stack.beads.size()));
    auto to = from;
    while (to != all.end() && *to < rankOf(last)) ++to;
    std::span<const std::uint32_t> ranks(from, to);
    if (end_rank < stack.beads.size() && all.back() >= end_rank) {
        const double band = layout_.lattice.background();
        ranks_.assign(from, to);
        for (auto rank = std::lower_bound(to, all.end(), end_rank); rank != all.end(); ++rank) {
            const voxelize::Extent& extent = stack.extentOf(*rank);
            if (extent.z_min - band <= z_max && extent.z_max + band >= z_min) ranks_.push_back(*rank);
        }
        ranks = ranks_;
    }
    if (ranks.empty()) return voxelize::LeafContent::outside;
    column_.open(origin[0], origin[1], ranks, end);
    return column_.evaluate(origin[2] >> 3, planes);
}

}  // namespace stratum::ondemand
