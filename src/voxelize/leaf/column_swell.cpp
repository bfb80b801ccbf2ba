// The part of LeafColumn that moves outlines out.
#include "voxelize/leaf/leaf_column.h"

#include <algorithm>
#include <cmath>

namespace stratum::voxelize {

void LeafColumn::placeSwell() {
    swell_placed_ = true;
    swell_sources_.clear();
    const auto nodeBelow = [](double mm) { return static_cast<int>(std::floor(mm / kNodeSpacing)); };
    first_node_i_ = nodeBelow(middle_x_ - half_extent_);
    first_node_j_ = nodeBelow(middle_y_ - half_extent_);
    const int last_i = nodeBelow(middle_x_ + half_extent_) + 1;
    const int last_j = nodeBelow(middle_y_ + half_extent_) + 1;
    nodes_i_ = last_i - first_node_i_ + 1;
    nodes_j_ = last_j - first_node_j_ + 1;
    swell_nodes_.resize(static_cast<std::size_t>(nodes_i_) * static_cast<std::size_t>(nodes_j_));
    const auto tileOf = [](int node) { return (node >= 0 ? node : node - kTileCells + 1) / kTileCells; };
    for (int y = tileOf(first_node_j_); y <= tileOf(last_j); ++y)
        for (int x = tileOf(first_node_i_); x <= tileOf(last_i); ++x) {
            const SwellTile* tile = stack_.swell->tile(toolpath_, stack_, x, y);
            if (tile == nullptr || tile->layers.empty()) continue;
            swell_sources_.push_back(
                {tile, std::max(x * kTileCells, first_node_i_), std::min(x * kTileCells + kTileCells - 1, last_i),
                 std::max(y * kTileCells, first_node_j_), std::min(y * kTileCells + kTileCells - 1, last_j)});
        }
    for (std::size_t c = 0; c < kColumnSamples; ++c) {
        const double x = (middle_x_ + static_cast<double>(grid_.qx.v[c]) / scale_) / kNodeSpacing - first_node_i_;
        const double y = (middle_y_ + static_cast<double>(grid_.qy.v[c]) / scale_) / kNodeSpacing - first_node_j_;
        swell_x_.v[c] = static_cast<float>(x);
        swell_y_.v[c] = static_cast<float>(y);
    }
}

bool LeafColumn::swell(std::uint32_t layer, PlanField& d, PlanField& sides2) {
    if (!swell_placed_) placeSwell();
    bool any = false;
    for (const SwellSource& source : swell_sources_) {
        const SwellTile::Nodes* nodes = source.tile->of(layer);
        if (nodes == nullptr) continue;
        if (!any) std::fill(swell_nodes_.begin(), swell_nodes_.end(), 0.0F);
        any = true;
        for (int j = source.first_j; j <= source.last_j; ++j)
            for (int i = source.first_i; i <= source.last_i; ++i)
                swell_nodes_[nodeIndex(j - first_node_j_, nodes_i_, i - first_node_i_)] =
                    (*nodes)[nodeIndex(j & (kTileCells - 1), kTileCells, i & (kTileCells - 1))];
    }
    if (!any) return false;
    const auto scale = static_cast<float>(scale_);
    for (std::size_t c = 0; c < kColumnSamples; ++c) {
        // Rounding must not leave the nodes.
        const int i = std::clamp(static_cast<int>(swell_x_.v[c]), 0, nodes_i_ - 2);
        const int j = std::clamp(static_cast<int>(swell_y_.v[c]), 0, nodes_j_ - 2);
        const float fx = swell_x_.v[c] - static_cast<float>(i);
        const float fy = swell_y_.v[c] - static_cast<float>(j);
        const float* low = swell_nodes_.data() + nodeIndex(j, nodes_i_, i);
        const float* high = low + nodes_i_;
        const float at_low = low[0] + fx * (low[1] - low[0]);
        const float at_high = high[0] + fx * (high[1] - high[0]);
        const float out = (at_low + fy * (at_high - at_low)) * scale;
        const float side = std::max(std::sqrt(sides2.v[c]) - out, 0.0F);
        sides2.v[c] = side * side;
        d.v[c] -= out;
    }
    return true;
}

}  // namespace stratum::voxelize
