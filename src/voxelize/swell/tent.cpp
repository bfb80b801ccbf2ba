#include "voxelize/swell/tent.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "voxelize/swell/tent.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace stratum::voxelize {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// out[n] = sum of (1 - |step| / (reach + 1)) from[n + step * stride]. Reads, and writes, whole vectors.
void SumAlong(const float* HWY_RESTRICT from, std::size_t stride, int reach, std::size_t count,
              float* HWY_RESTRICT out) {
    const hn::CappedTag<float, 16> d;
    for (std::size_t n = 0; n < count; n += hn::Lanes(d)) {
        auto sum = hn::Zero(d);
        for (int step = -reach; step <= reach; ++step) {
            const float weight = 1 - static_cast<float>(step < 0 ? -step : step) / static_cast<float>(reach + 1);
            const float* at = from + n + static_cast<std::ptrdiff_t>(step) * static_cast<std::ptrdiff_t>(stride);
            // No fused multiply-add: see leaf_kernels.h.
            sum = hn::Add(sum, hn::Mul(hn::Set(d, weight), hn::LoadU(d, at)));
        }
        hn::StoreU(sum, d, out + n);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace stratum::voxelize
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stratum::voxelize {

HWY_EXPORT(SumAlong);

namespace {

// A vector that begins at the last node of a row reads and writes this many nodes more.
constexpr std::size_t kMostLanes = 16;
constexpr std::size_t kPad = Tent::kMostReach + kMostLanes;

}  // namespace

Tent::Tent(int edge)
    : edge_(edge),
      stride_(static_cast<std::size_t>(edge) + 2 * kPad),
      given_(stride_ * (static_cast<std::size_t>(edge) + 2 * kPad), 0.0F),
      rows_(given_.size(), 0.0F) {}

void Tent::sum(const std::vector<float>& values, int reach, std::vector<float>& out) {
    const auto edge = static_cast<std::size_t>(edge_);
    const auto rowOf = [this](std::vector<float>& padded, std::size_t row) {
        return padded.data() + (row + kPad) * stride_ + kPad;
    };
    const auto sumAlong = [](const float* from, std::size_t stride, int reach, std::size_t count, float* out) {
        HWY_DYNAMIC_DISPATCH(SumAlong)(from, stride, reach, count, out);
    };
    for (std::size_t row = 0; row < edge; ++row) {
        std::copy_n(values.data() + row * edge, edge, rowOf(given_, row));
        sumAlong(rowOf(given_, row), 1, reach, edge, rowOf(rows_, row));
        // What the last vector wrote beyond the square.
        std::fill_n(rowOf(rows_, row) + edge, kMostLanes, 0.0F);
    }
    out.resize(values.size());
    // Row 0 of given_ is not needed any more, and has room for whole vectors.
    float* const line = rowOf(given_, 0);
    for (std::size_t row = 0; row < edge; ++row) {
        sumAlong(rowOf(rows_, row), stride_, reach, edge, line);
        std::copy_n(line, edge, out.data() + row * edge);
    }
    std::fill_n(line + edge, kMostLanes, 0.0F);
}

}  // namespace stratum::voxelize
#endif  // HWY_ONCE
