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
template <int kReach>
HWY_INLINE void sumAlong(const float* HWY_RESTRICT from, std::size_t stride, std::size_t count,
                         float* HWY_RESTRICT out) {
    const hn::CappedTag<float, 16> d;
    for (std::size_t n = 0; n < count; n += hn::Lanes(d)) {
        auto sum = hn::LoadU(d, from + n);
        for (int step = 1; step <= kReach; ++step) {
            const auto weight = hn::Set(d, 1 - static_cast<float>(step) / static_cast<float>(kReach + 1));
            const auto way = static_cast<std::ptrdiff_t>(stride) * step;
            const auto both = hn::Add(hn::LoadU(d, from + n - way), hn::LoadU(d, from + n + way));
            // No fused multiply-add: see leaf_kernels.h.
            sum = hn::Add(sum, hn::Mul(weight, both));
        }
        hn::StoreU(sum, d, out + n);
    }
}

void SumAlong(const float* HWY_RESTRICT from, std::size_t stride, int reach, std::size_t count,
              float* HWY_RESTRICT out) {
    switch (reach) {
        case 0:
            return sumAlong<0>(from, stride, count, out);
        case 1:
            return sumAlong<1>(from, stride, count, out);
        case 2:
            return sumAlong<2>(from, stride, count, out);
        case 3:
            return sumAlong<3>(from, stride, count, out);
        default:
            return sumAlong<Tent::kMostReach>(from, stride, count, out);
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
      stride_(static_cast<std::size_t>(edge) + kPad),
      line_(stride_ + kPad),
      rows_(stride_ * (static_cast<std::size_t>(edge) + std::size_t{2} * kMostReach) + kMostLanes, 0.0F) {}

void Tent::sum(const std::vector<float>& values, const NodeBox& from, int reach, const NodeBox& to,
               std::vector<float>& out) {
    if (to.empty()) return;
    const auto edge = static_cast<std::size_t>(edge_);
    const auto count = static_cast<std::size_t>(to.x1 - to.x0);
    const auto rowOf = [&](int row) {
        return rows_.data() + static_cast<std::size_t>(row + kMostReach) * stride_ + static_cast<std::size_t>(to.x0);
    };
    const auto sumAlong = [reach, count](const float* values, std::size_t stride, float* sums) {
        HWY_DYNAMIC_DISPATCH(SumAlong)(values, stride, reach, count, sums);
    };
    const NodeBox read = to.grown(reach).within(from);
    float* const line = line_.data() + kPad;
    std::fill(line_.begin(), line_.end(), 0.0F);
    for (int row = to.y0 - reach; row < to.y1 + reach; ++row) {
        if (read.empty() || row < read.y0 || row >= read.y1) {
            std::fill_n(rowOf(row), count, 0.0F);
            continue;
        }
        std::copy_n(values.data() + static_cast<std::size_t>(row) * edge + read.x0, read.x1 - read.x0, line + read.x0);
        sumAlong(line + to.x0, 1, rowOf(row));
    }
    for (int row = to.y0; row < to.y1; ++row) {
        sumAlong(rowOf(row), stride_, line);
        std::copy_n(line, count, out.data() + static_cast<std::size_t>(row) * edge + to.x0);
    }
}

}  // namespace stratum::voxelize
#endif  // HWY_ONCE
