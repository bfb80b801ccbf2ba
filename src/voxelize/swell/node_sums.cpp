#include "voxelize/swell/node_sums.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "voxelize/swell/node_sums.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "voxelize/leaf/path_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace stratum::voxelize {
namespace HWY_NAMESPACE {

void PressLayer(const PlanField& sides2, float radius, float straight, PressedLayer& out) {
    const F f;
    const VF zero = hn::Zero(f);
    VF least = hn::Set(f, 3e38F);
    VF most = zero;
    forEachVector([&](std::size_t c) HWY_ATTR {
        const VF side2 = hn::Load(f, sides2.v + c);
        least = hn::Min(least, side2);
        most = hn::Max(most, side2);
    });
    const float reach = radius + static_cast<float>(kMostSwell);
    out.kind = PressedLayer::Kind::nothing;
    if (hn::GetLane(hn::MinOfLanes(f, least)) >= reach * reach) return;
    out.kind = PressedLayer::Kind::flat;
    if (!(hn::GetLane(hn::MaxOfLanes(f, most)) > 0)) return;
    out.kind = PressedLayer::Kind::some;
    out.solid = 0;
    const VF radius2 = hn::Set(f, radius * radius);
    const auto thickness = [&](VF side) HWY_ATTR {
        const VF half2 = hn::Sub(radius2, hn::Mul(side, side));
        const VF half = hn::Sqrt(hn::Max(half2, zero));
        const VF whole = hn::Add(hn::Set(f, straight), hn::Add(half, half));
        return hn::IfThenElseZero(hn::Gt(half2, zero), whole);
    };
    forEachVector([&](std::size_t c) HWY_ATTR {
        const VF side = hn::Sqrt(hn::Load(f, sides2.v + c));
        const VF held = thickness(side);
        hn::Store(held, f, out.fields[0].v + c);
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(f, hn::Gt(held, zero), bits);
        std::uint64_t word = 0;
        std::memcpy(&word, bits, sizeof(word));
        out.solid |= word << c;
        for (std::size_t level = 1; level < PressedLayer::kFields; ++level) {
            const auto swell = static_cast<float>(TileSums::kSwells[level - 1]);
            const VF moved = thickness(hn::Max(hn::Sub(side, hn::Set(f, swell)), zero));
            hn::Store(hn::Sub(moved, held), f, out.fields[level].v + c);
        }
    });
}

// `sums`: of each cell those of its corners, by field.
void SumFields(const NodeSums::Weights& weights, const std::array<PlanField, NodeSums::kFields>& fields,
               float (*HWY_RESTRICT sums)[NodeSums::kCorners * NodeSums::kFields]) {
    static_assert(NodeSums::kFields == 4 && NodeSums::kCells == 4);
    // By point, the fields side by side: a block of 128 bits, which each corner takes.
    alignas(64) float by_point[kColumnSamples][NodeSums::kFields];
    const F f;
    forEachVector([&](std::size_t c) HWY_ATTR {
        hn::StoreInterleaved4(hn::Load(f, fields[0].v + c), hn::Load(f, fields[1].v + c), hn::Load(f, fields[2].v + c),
                              hn::Load(f, fields[3].v + c), f, by_point[c]);
    });
    constexpr std::size_t kLanes = NodeSums::kCorners * NodeSums::kFields;
    for (std::size_t lane = 0; lane < kLanes; lane += hn::Lanes(f)) {
        VF a = hn::Zero(f);
        VF b = a;
        VF c = a;
        VF d = a;
        for (std::size_t n = 0; n < NodeSums::kCellPoints; ++n) {
            const auto add = [&](VF sum, std::size_t cell) HWY_ATTR {
                const VF values = hn::LoadDup128(f, by_point[weights.point[n][cell]]);
                return hn::Add(sum, hn::Mul(hn::Load(f, weights.of[n][cell] + lane), values));
            };
            a = add(a, 0);
            b = add(b, 1);
            c = add(c, 2);
            d = add(d, 3);
        }
        hn::StoreU(a, f, sums[0] + lane);
        hn::StoreU(b, f, sums[1] + lane);
        hn::StoreU(c, f, sums[2] + lane);
        hn::StoreU(d, f, sums[3] + lane);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace stratum::voxelize
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stratum::voxelize {

HWY_EXPORT(PressLayer);
HWY_EXPORT(SumFields);

namespace {

// The node at a corner of a cell, in the square's rows.
std::size_t nodeOf(std::size_t cell, std::size_t corner) {
    const std::size_t column = cell % kSquareCells + corner % 2;
    const std::size_t row = cell / kSquareCells + corner / 2;
    return row * kSquareNodes + column;
}

}  // namespace

void pressLayer(const PlanField& sides2, float radius, float straight, PressedLayer& out) {
    HWY_DYNAMIC_DISPATCH(PressLayer)(sides2, radius, straight, out);
}

NodeSums::NodeSums(const ColumnGrid& points) {
    constexpr double kPointArea =
        kSquareCells * kSquareCells * kNodeSpacing * kNodeSpacing / static_cast<double>(kColumnSamples);
    std::array<std::size_t, kCells> found{};
    for (std::uint32_t c = 0; c < kColumnSamples; ++c) {
        const double x = static_cast<double>(points.qx.v[c]) / kNodeSpacing + 1;
        const double y = static_cast<double>(points.qy.v[c]) / kNodeSpacing + 1;
        const std::size_t cell = (y < 1 ? 0 : kSquareCells) + (x < 1 ? 0 : 1);
        const std::size_t n = found[cell]++;
        weights_.point[n][cell] = c;
        const double fx = nodeShare(x < 1 ? x : x - 1);
        const double fy = nodeShare(y < 1 ? y : y - 1);
        for (std::size_t corner = 0; corner < kCorners; ++corner) {
            const double weight = kPointArea * (corner % 2 == 0 ? 1 - fx : fx) * (corner / 2 == 0 ? 1 - fy : fy);
            for (std::size_t field = 0; field < kFields; ++field)
                weights_.of[n][cell][corner * kFields + field] = static_cast<float>(weight);
        }
    }
    std::array<PlanField, kFields> ones{};
    std::fill(std::begin(ones[0].v), std::end(ones[0].v), 1.0F);
    const Sums sums = of(ones);
    for (std::size_t node = 0; node < kNodes; ++node) area_[node] = sums[node][0];
}

NodeSums::Sums NodeSums::of(const std::array<PlanField, kFields>& fields) const {
    alignas(64) float by_cell[kCells][kCorners * kFields];
    HWY_DYNAMIC_DISPATCH(SumFields)(weights_, fields, by_cell);
    Sums sums{};
    for (std::size_t cell = 0; cell < kCells; ++cell)
        for (std::size_t corner = 0; corner < kCorners; ++corner)
            for (std::size_t field = 0; field < kFields; ++field)
                sums[nodeOf(cell, corner)][field] += by_cell[cell][corner * kFields + field];
    return sums;
}

}  // namespace stratum::voxelize
#endif  // HWY_ONCE
