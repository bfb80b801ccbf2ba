// The plan fields of layers over columns of leaves: those in use, and those that later leaves may need again.
#pragma once

#include "voxelize/leaf/leaf_kernels.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace stratum::voxelize {

/// One layer over one column.
struct PlanLayer {
    std::uint32_t layer;                              // index into LayerStack::layers
    double center_z, half_height, radius, half_side;  // mm
    bool beyond_band;                                 // no sample of the column is within the band of it
    bool owned;                                       // whether `owners` is set
    bool rises;                                       // whether `rise` is used
    double most_rise;                                 // mm, the most of it
    PlanField d, sides2;                              // d: where beads settle, closed by what welds close
    PlanField rise;                                   // world units; below 0 in crowns
    PlanOwners owners;
};

/// Of which beads a PlanLayer is: those of a layer below an index in the toolpath, over the column from voxel (i, j).
struct PlanKey {
    int i, j;
    std::uint32_t layer, end;

    bool operator==(const PlanKey&) const = default;
};

/// Slots of PlanLayer. Of one thread. A column that goes up leaf by leaf needs each of its layers once. Single leaves
/// here and there need those of their neighbours again, and of the leaf itself: with `keep` a slot keeps its layer
/// after release() until another one of the same place takes it.
class PlanLayers {
public:
    explicit PlanLayers(bool keep);

    /// A slot in use from now on; nothing else changes it until release(). It may have to be filled; see isFilled().
    std::uint32_t take(const PlanKey& key);
    /// Whether the slot has what was put into it for that key.
    bool isFilled(std::uint32_t slot) const { return slot < places_ && keys_[slot].has_value(); }
    void setFilled(std::uint32_t slot, const PlanKey& key) {
        if (slot < places_) keys_[slot] = key;
    }
    void release(std::uint32_t slot);

    PlanLayer& operator[](std::uint32_t slot) { return slot < places_ ? kept_[slot] : more_[slot - places_]; }
    const PlanLayer& operator[](std::uint32_t slot) const {
        return slot < places_ ? kept_[slot] : more_[slot - places_];
    }

private:
    // Kept layers have one place each, which neighbours do not share: by column and by layer.
    static constexpr std::uint32_t kSide = 16;
    static std::uint32_t placeOf(const PlanKey& key);

    const std::uint32_t places_;                // of kept_
    std::vector<std::optional<PlanKey>> keys_;  // of kept_; none: not filled
    std::vector<bool> in_use_;                  // of kept_
    std::unique_ptr<PlanLayer[]> kept_;         // not initialized: most are never used
    std::vector<PlanLayer> more_;               // without keep, and where a place is in use
    std::vector<std::uint32_t> free_;           // of more_
};

}  // namespace stratum::voxelize
