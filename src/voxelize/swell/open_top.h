// Which points of a column's layers have plastic with no other layer on it.
#pragma once

#include "voxelize/beads/layer_stack.h"
#include "voxelize/leaf/leaf_kernels.h"

#include <cstdint>
#include <vector>

namespace stratum::voxelize {

static_assert(kColumnSamples == 64, "a word has a bit for each point of a column");

/// The top of a layer over a column; bit c is point c.
struct OpenTop {
    std::uint32_t layer = 0;  ///< index into LayerStack::layers
    std::uint64_t solid = 0;  ///< with plastic
    std::uint64_t open = 0;   ///< of them, those that no layer covers which is welded to this one from above
};

/// Adds a layer with those points; call in ascending order, then coverTops().
inline void addTop(std::uint32_t layer, std::uint64_t solid, std::vector<OpenTop>& tops) {
    tops.push_back({layer, solid, solid});
}

/// Of one column: takes from each layer's open points those with plastic of a layer on it.
void coverTops(const LayerStack& stack, std::vector<OpenTop>& tops);

}  // namespace stratum::voxelize
