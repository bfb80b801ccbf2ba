// The part of LeafColumn that moves outlines out and tops up.
#include "voxelize/leaf/leaf_column.h"
#include "voxelize/leaf/swell_kernels.h"

#include <algorithm>
#include <cmath>

namespace stratum::voxelize {

void LeafColumn::placeSwell() {
    swell_placed_ = true;
    swell_tiles_z_.reset();
    const double spacing = nodeSpacing(stack_);
    const auto nodeBelow = [spacing](double mm) { return static_cast<int>(std::floor(mm / spacing)); };
    first_node_i_ = nodeBelow(middle_x_ - half_extent_);
    first_node_j_ = nodeBelow(middle_y_ - half_extent_);
    nodes_i_ = nodeBelow(middle_x_ + half_extent_) + 2 - first_node_i_;
    nodes_j_ = nodeBelow(middle_y_ + half_extent_) + 2 - first_node_j_;
    swell_nodes_.resize(static_cast<std::size_t>(nodes_i_) * static_cast<std::size_t>(nodes_j_));
    const auto rampsOf = [this, spacing](const PlanField& q, double middle, int first_node, int nodes, auto& ramps) {
        ramps.resize(static_cast<std::size_t>(nodes - 1));
        nodeRamps(q, static_cast<float>(1 / (scale_ * spacing)), static_cast<float>(middle / spacing - first_node),
                  ramps);
    };
    rampsOf(grid_.qx, middle_x_, first_node_i_, nodes_i_, ramps_x_);
    rampsOf(grid_.qy, middle_y_, first_node_j_, nodes_j_, ramps_y_);
}

void LeafColumn::findSwellTiles(std::uint32_t z) {
    if (!swell_placed_) placeSwell();
    if (swell_tiles_z_ == z) return;
    swell_sources_.clear();
    const int last_i = first_node_i_ + nodes_i_ - 1;
    const int last_j = first_node_j_ + nodes_j_ - 1;
    for (int y = floorDivide(first_node_j_, kTileCells); y <= floorDivide(last_j, kTileCells); ++y)
        for (int x = floorDivide(first_node_i_, kTileCells); x <= floorDivide(last_i, kTileCells); ++x) {
            const SwellTile* tile = stack_.swell->tile(toolpath_, stack_, {x, y, z});
            if (tile == nullptr) continue;
            swell_sources_.push_back(
                {tile, std::max(x * kTileCells, first_node_i_), std::min(x * kTileCells + kTileCells - 1, last_i),
                 std::max(y * kTileCells, first_node_j_), std::min(y * kTileCells + kTileCells - 1, last_j)});
        }
    swell_tiles_z_ = z;
}

void LeafColumn::prefetchSwell(std::uint32_t layer) {
    findSwellTiles(layer / kTileLayers);
    constexpr int kBlock = NodeValues::kBlock;
    const auto blockOf = [](int node) { return node & (kTileCells - 1) & -kBlock; };
    for (const SwellSource& source : swell_sources_)
        for (const auto kind : {&SwellTile::out, &SwellTile::rise, &SwellTile::open}) {
            const NodeValues& values = source.tile->*kind;
            if (!values.has(layer)) continue;
            const NodeValues::OfLayer of_layer = values.of(layer);
            for (int j = blockOf(source.first_j); j <= blockOf(source.last_j); j += kBlock)
                for (int i = blockOf(source.first_i); i <= blockOf(source.last_i); i += kBlock)
                    __builtin_prefetch(of_layer.block(i, j));
        }
}

bool LeafColumn::gatherNodes(std::uint32_t layer, NodeValues SwellTile::*kind) {
    findSwellTiles(layer / kTileLayers);
    bool found = false;
    for (const SwellSource& source : swell_sources_) {
        const NodeValues& values = source.tile->*kind;
        if (!values.has(layer)) continue;
        if (!found) std::fill(swell_nodes_.begin(), swell_nodes_.end(), 0.0F);
        found = true;
        const NodeValues::OfLayer of_layer = values.of(layer);
        float* row = swell_nodes_.data() + nodeIndex(source.first_j - first_node_j_, nodes_i_, 0);
        for (int j = source.first_j; j <= source.last_j; ++j, row += nodes_i_)
            for (int i = source.first_i; i <= source.last_i; ++i)
                row[i - first_node_i_] = of_layer.at(i & (kTileCells - 1), j & (kTileCells - 1));
    }
    return found;
}

bool LeafColumn::valuesOf(std::uint32_t layer, NodeValues SwellTile::*kind, double scale, PlanField& values) {
    if (!gatherNodes(layer, kind)) return false;
    largest_node_ = *std::max_element(swell_nodes_.begin(), swell_nodes_.end());
    if (!(largest_node_ > 0)) return false;
    betweenNodes(ramps_x_, ramps_y_, swell_nodes_, static_cast<float>(scale), values);
    return true;
}

bool LeafColumn::swell(std::uint32_t layer, PlanField& d, PlanField& sides2, float& least) {
    if (!valuesOf(layer, &SwellTile::out, scale_, between_)) return false;
    least = moveOut(between_, d, sides2);
    return true;
}

bool LeafColumn::raise(std::uint32_t layer, const PlanField& nearest, PlanField& rise, double& most) {
    constexpr double kRounding = 1 + 1e-5;
    most = 0;
    const Layer& of = stack_.layers[layer];
    const bool rises = valuesOf(layer, &SwellTile::rise, scale_, rise);
    if (rises) most = kRounding * static_cast<double>(largest_node_);
    if (!(of.crown > 0) || !valuesOf(layer, &SwellTile::open, 1, between_)) return rises;
    if (!rises) std::fill(std::begin(rise.v), std::end(rise.v), 0.0F);
    lowerByCrown(between_, nearest, static_cast<float>(of.crown * scale_), static_cast<float>(of.radius * scale_),
                 rise);
    return true;
}

}  // namespace stratum::voxelize
