#include "voxelize/leaf/plan_layers.h"

namespace stratum::voxelize {

PlanLayers::PlanLayers(bool keep) : places_(keep ? kSide * kSide * kSide : 0) {
    if (!keep) return;
    keys_.resize(places_);
    in_use_.resize(places_);
    kept_ = std::make_unique_for_overwrite<PlanLayer[]>(places_);
}

std::uint32_t PlanLayers::placeOf(const PlanKey& key) {
    const auto part = [](std::uint32_t value) { return value % kSide; };
    const auto columnOf = [](int voxel) { return static_cast<std::uint32_t>(voxel) / 8; };
    return (part(columnOf(key.i)) * kSide + part(columnOf(key.j))) * kSide + part(key.layer);
}

std::uint32_t PlanLayers::take(const PlanKey& key) {
    if (kept_ != nullptr) {
        const std::uint32_t place = placeOf(key);
        if (!in_use_[place]) {
            in_use_[place] = true;
            if (keys_[place] != key) keys_[place].reset();
            return place;
        }
    }
    if (free_.empty()) {
        free_.push_back(places_ + static_cast<std::uint32_t>(more_.size()));
        more_.emplace_back();
    }
    const std::uint32_t slot = free_.back();
    free_.pop_back();
    return slot;
}

void PlanLayers::release(std::uint32_t slot) {
    if (slot < places_)
        in_use_[slot] = false;
    else
        free_.push_back(slot);
}

}  // namespace stratum::voxelize
