#include "march/brick/neighbor_signs.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numbers>
#include <type_traits>

namespace stratum::march {
namespace {

constexpr std::size_t kEdge = LeafSource::kLeafEdge;
constexpr std::size_t kLast = kEdge - 1;

int magnitude(std::int16_t sample) { return std::abs(int{sample}); }
float magnitude(float sample) { return std::abs(sample); }

// The least distance from zero of a leaf's nine samples over (x, y).
template <typename T>
auto leastOf(const LeafSamples<T>& leaf, const Cap<T>& cap, std::size_t x, std::size_t y) {
    auto least = magnitude(cap.value[(x * kEdge + y) * cap.stride]);
    const T* column = leaf.value.data() + (x * kEdge + y) * kEdge;
    for (std::size_t z = 0; z < kEdge; ++z) least = std::min(least, magnitude(column[z]));
    return static_cast<double>(least);
}

}  // namespace

NeighborSigns::NeighborSigns(const LeafField& field, double quantum) {
    const double voxel = field.transform().voxelSize()[0];
    beside_ = (voxel + field.signSlack()) / quantum;
    diagonally_ = (std::numbers::sqrt2 * voxel + field.signSlack()) / quantum;
}

template <typename T>
void NeighborSigns::assume(BrickParts<T>& parts) const {
    // Whole numbers are rounded, and one lower below zero.
    constexpr double kStored = std::is_integral_v<T> ? 2 : 0;
    const double beside = beside_ + kStored;
    const double diagonally = diagonally_ + kStored;
    const LeafSamples<T>* const leaf = parts.leaf[0];
    const T outside = parts.tile[0];
    if (leaf == nullptr) {
        if (static_cast<double>(outside) > diagonally) parts.assumed = {false, true, true, true};
        return;
    }
    const Cap<T>& cap = parts.cap[0];
    // The last samples of both axes are corners of the same cells as the diagonal neighbour's first ones.
    if (!(leastOf(*leaf, cap, kLast, kLast) > diagonally)) return;
    const auto assumeSignOf = [&](std::size_t x, std::size_t y, std::size_t part) {
        const bool inside = leaf->value[(x * kEdge + y) * kEdge] < 0;
        parts.assumed[part] = true;
        parts.tile[part] = parts.cap_tile[part] = inside ? static_cast<T>(-outside) : outside;
    };
    assumeSignOf(kLast, kLast, 3);
    bool along_x = true;
    bool along_y = true;
    for (std::size_t n = 0; n < kLast; ++n) {
        along_x = along_x && leastOf(*leaf, cap, kLast, n) > beside;
        along_y = along_y && leastOf(*leaf, cap, n, kLast) > beside;
    }
    if (along_x) assumeSignOf(kLast, 0, 2);
    if (along_y) assumeSignOf(0, kLast, 1);
}

template void NeighborSigns::assume(BrickParts<float>&) const;
template void NeighborSigns::assume(BrickParts<std::int16_t>&) const;

}  // namespace stratum::march
