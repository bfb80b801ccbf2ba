// The part of LeafColumn that moves outlines out and tops up.
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
    const auto tileOf = [](int node) { return (node >= 0 ? node : node - kTileCells + 1) / kTileCells; };
    for (int y = tileOf(first_node_j_); y <= tileOf(last_j); ++y)
        for (int x = tileOf(first_node_i_); x <= tileOf(last_i); ++x) {
            const SwellTile* tile = stack_.swell->tile(toolpath_, stack_, x, y);
            if (tile == nullptr || tile->layers.empty()) continue;
            swell_sources_.push_back({tile, nullptr, std::max(x * kTileCells, first_node_i_),
                                      std::min(x * kTileCells + kTileCells - 1, last_i),
                                      std::max(y * kTileCells, first_node_j_),
                                      std::min(y * kTileCells + kTileCells - 1, last_j)});
        }
    for (std::size_t c = 0; c < kColumnSamples; ++c) {
        const double x = (middle_x_ + static_cast<double>(grid_.qx.v[c]) / scale_) / kNodeSpacing - first_node_i_;
        const double y = (middle_y_ + static_cast<double>(grid_.qy.v[c]) / scale_) / kNodeSpacing - first_node_j_;
        // Rounding must not leave the nodes.
        const int i = std::clamp(static_cast<int>(x), 0, nodes_i_ - 2);
        const int j = std::clamp(static_cast<int>(y), 0, nodes_j_ - 2);
        swell_node_[c] = static_cast<std::uint32_t>(nodeIndex(j, nodes_i_, i));
        swell_x_.v[c] = nodeShare(std::clamp(static_cast<float>(x - i), 0.0F, 1.0F));
        swell_y_.v[c] = nodeShare(std::clamp(static_cast<float>(y - j), 0.0F, 1.0F));
    }
}

void LeafColumn::findSwell(std::uint32_t layer) {
    if (!swell_placed_) placeSwell();
    for (SwellSource& source : swell_sources_) source.layer = source.tile->of(layer);
}

bool LeafColumn::gatherNodes(std::vector<float> SwellTile::Layer::*values, std::vector<float>& nodes) const {
    bool found = false;
    for (const SwellSource& source : swell_sources_) {
        const SwellTile::Layer* from = source.layer;
        if (from == nullptr || (from->*values).empty()) continue;
        if (!found) nodes.assign(static_cast<std::size_t>(nodes_i_) * static_cast<std::size_t>(nodes_j_), 0.0F);
        found = true;
        for (int j = source.first_j; j <= source.last_j; ++j)
            for (int i = source.first_i; i <= source.last_i; ++i)
                nodes[nodeIndex(j - first_node_j_, nodes_i_, i - first_node_i_)] =
                    (from->*values)[nodeIndex(j & (kTileCells - 1), kTileCells, i & (kTileCells - 1))];
    }
    return found;
}

void LeafColumn::betweenNodes(const std::vector<float>& nodes, float scale, PlanField& values) const {
    for (std::size_t c = 0; c < kColumnSamples; ++c) {
        const float fx = swell_x_.v[c];
        const float fy = swell_y_.v[c];
        const float* low = nodes.data() + swell_node_[c];
        const float* high = low + nodes_i_;
        const float at_low = low[0] + fx * (low[1] - low[0]);
        const float at_high = high[0] + fx * (high[1] - high[0]);
        values.v[c] = (at_low + fy * (at_high - at_low)) * scale;
    }
}

bool LeafColumn::swell(PlanField& d, PlanField& sides2) {
    if (!gatherNodes(&SwellTile::Layer::out, swell_nodes_)) return false;
    betweenNodes(swell_nodes_, static_cast<float>(scale_), between_);
    moveOut(between_, d, sides2);
    return true;
}

bool LeafColumn::raise(const Layer& of, const PlanField& nearest, PlanField& rise) {
    const bool rises = gatherNodes(&SwellTile::Layer::rise, swell_nodes_);
    const bool crowned = of.crown > 0 && gatherNodes(&SwellTile::Layer::open, open_nodes_);
    if (!rises && !crowned) return false;
    if (rises)
        betweenNodes(swell_nodes_, static_cast<float>(scale_), rise);
    else
        std::fill(std::begin(rise.v), std::end(rise.v), 0.0F);
    if (!crowned) return true;
    betweenNodes(open_nodes_, 1, between_);
    const auto crown = static_cast<float>(of.crown * scale_);
    const auto radius = static_cast<float>(of.radius * scale_);
    for (std::size_t c = 0; c < kColumnSamples; ++c)
        rise.v[c] -= between_.v[c] * crownDepth(crown, radius, nearest.v[c]);
    return true;
}

}  // namespace stratum::voxelize
