// Which layers the sums of a tile need besides its own.
#pragma once

#include "voxelize/beads/layer_stack.h"
#include "voxelize/leaf/leaf_kernels.h"

#include <cstdint>
#include <span>
#include <vector>

namespace stratum::voxelize {

// Which points of a column's layers have plastic with no other layer on it.

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

/// Layers that lie on a tile's own cover their tops. And layers may reach into each other, such as threads of bridges
/// and what they lie on: what one shares with those before it, it does not hold. Most reach into none.
class LayerNeeds {
public:
    explicit LayerNeeds(const LayerStack& stack);

    /// Whether any layer reaches into another.
    bool anyOverlap() const { return any_overlap_; }
    /// Whether a layer begins clearly below the top of one before it.
    bool takes(std::uint32_t layer) const { return takes_[layer]; }
    /// Whether one behind it that takes begins below its top.
    bool gives(std::uint32_t layer) const { return gives_[layer]; }

    /// Layers that the tiles at a TilePlace::z need and don't have, ascending.
    std::span<const std::uint32_t> ofOthers(std::uint32_t z) const {
        return std::span(others_).subspan(first_[z], first_[z + 1] - first_[z]);
    }

private:
    std::vector<bool> takes_, gives_;
    bool any_overlap_ = false;
    std::vector<std::uint32_t> others_;
    std::vector<std::size_t> first_;  // by z, into others_
};

}  // namespace stratum::voxelize
