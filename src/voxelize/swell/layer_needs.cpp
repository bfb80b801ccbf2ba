#include "voxelize/swell/layer_needs.h"

#include "voxelize/swell/swell_field.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace stratum::voxelize {

void coverTops(const LayerStack& stack, std::vector<OpenTop>& tops) {
    // Both lists ascend by the upper layer, and what it lies on is most often the top before it.
    auto weld = stack.welds.begin();
    for (auto upper = tops.begin(); upper != tops.end(); ++upper) {
        if (weld != stack.welds.end() && weld->upper < upper->layer)
            weld = std::lower_bound(weld, stack.welds.end(), upper->layer,
                                    [](const Weld& pair, std::uint32_t layer) { return pair.upper < layer; });
        for (; weld != stack.welds.end() && weld->upper == upper->layer; ++weld) {
            auto lower = upper == tops.begin() ? upper : upper - 1;
            if (lower->layer != weld->lower)
                lower = std::lower_bound(tops.begin(), tops.end(), weld->lower,
                                         [](const OpenTop& top, std::uint32_t layer) { return top.layer < layer; });
            if (lower != tops.end() && lower->layer == weld->lower) lower->open &= ~upper->solid;
        }
    }
}

namespace {

// Before it is raised.
double topOf(const Layer& layer) { return layer.center_z + layer.halfHeight(); }

}  // namespace

LayerNeeds::LayerNeeds(const LayerStack& stack) : takes_(stack.layers.size()), gives_(stack.layers.size()) {
    const auto count = static_cast<std::uint32_t>(stack.layers.size());
    double top = std::numeric_limits<double>::lowest();
    double thickest = 0;
    for (std::uint32_t n = 0; n < count; ++n) {
        const Layer& layer = stack.layers[n];
        takes_[n] = layer.bottom() + 2 * kWeldGap * layer.halfHeight() < top;
        top = std::max(top, topOf(layer));
        thickest = std::max(thickest, layer.halfHeight());
        any_overlap_ = any_overlap_ || takes_[n];
    }
    double bottom = std::numeric_limits<double>::max();
    for (std::uint32_t n = count; n-- > 0;) {
        gives_[n] = topOf(stack.layers[n]) > bottom;
        if (takes_[n]) bottom = std::min(bottom, stack.layers[n].bottom());
    }
    // By tile and layer.
    std::vector<std::pair<std::uint32_t, std::uint32_t>> others;
    for (const Weld& weld : stack.welds)
        if (weld.lower / kTileLayers != weld.upper / kTileLayers)
            others.emplace_back(weld.lower / kTileLayers, weld.upper);
    const std::uint32_t tiles = tilesHigh(stack);
    for (std::uint32_t z = 0; any_overlap_ && z < tiles; ++z) {
        double lowest = std::numeric_limits<double>::max();
        for (std::uint32_t n = z * kTileLayers; n < std::min((z + 1) * kTileLayers, count); ++n)
            if (takes_[n]) lowest = std::min(lowest, stack.layers[n].bottom());
        // Layers ascend by their centers.
        for (std::uint32_t n = z * kTileLayers; n-- > 0 && stack.layers[n].center_z + thickest > lowest;)
            if (gives_[n] && topOf(stack.layers[n]) > lowest) others.emplace_back(z, n);
    }
    std::sort(others.begin(), others.end());
    others.erase(std::unique(others.begin(), others.end()), others.end());
    first_.assign(std::size_t{tiles} + 1, 0);
    for (const auto& [z, layer] : others) {
        ++first_[z + 1];
        others_.push_back(layer);
    }
    for (std::uint32_t z = 0; z < tiles; ++z) first_[z + 1] += first_[z];
}

}  // namespace stratum::voxelize
