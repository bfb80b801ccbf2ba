#include "voxelize/swell/node_sums.h"

#include <algorithm>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "voxelize/swell/node_sums.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "voxelize/leaf/path_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace stratum::voxelize {
namespace HWY_NAMESPACE {

void PressLayer(const PlanField& sides2, float radius, float straight, double scale, PressedLayer& out) {
    const F f;
    const VF zero = hn::Zero(f);
    VF least = hn::Set(f, 3e38F);
    VF most = zero;
    forEachVector([&](std::size_t c) HWY_ATTR {
        const VF side2 = hn::Load(f, sides2.v + c);
        least = hn::Min(least, side2);
        most = hn::Max(most, side2);
    });
    const float reach = radius + static_cast<float>(kMostSwell * scale);
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
        hn::Store(hn::Neg(held), f, out.fields[0].v + c);
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(f, hn::Gt(held, zero), bits);
        std::uint64_t word = 0;
        std::memcpy(&word, bits, sizeof(word));
        out.solid |= word << c;
        for (std::size_t level = 1; level < PressedLayer::kFields; ++level) {
            const auto swell = static_cast<float>(TileSums::kSwells[level - 1] * scale);
            const VF moved = thickness(hn::Max(hn::Sub(side, hn::Set(f, swell)), zero));
            hn::Store(hn::Sub(moved, held), f, out.fields[level].v + c);
        }
    });
}

void AddFields(const NodeSums::Weights& weights, const std::array<PlanField, NodeSums::kFields>& fields,
               float* HWY_RESTRICT nodes, std::size_t stride) {
    static_assert(NodeSums::kFields == 4 && NodeSums::kCells == 4 && kSquareNodes == 3);
    // By point, the fields side by side: a block of 128 bits, which each corner takes.
    alignas(64) float by_point[kColumnSamples][NodeSums::kFields];
    const F f;
    forEachVector([&](std::size_t c) HWY_ATTR {
        hn::StoreInterleaved4(hn::Load(f, fields[0].v + c), hn::Load(f, fields[1].v + c), hn::Load(f, fields[2].v + c),
                              hn::Load(f, fields[3].v + c), f, by_point[c]);
    });
    // Of each cell the sums of its corners, by field.
    constexpr std::size_t kLanes = NodeSums::kCorners * NodeSums::kFields;
    alignas(64) float sums[NodeSums::kCells][kLanes];
    for (std::size_t lane = 0; lane < kLanes; lane += hn::Lanes(f)) {
        VF a = hn::Zero(f);
        VF b = a;
        VF c = a;
        VF d = a;
        for (std::size_t n = 0; n < NodeSums::kCellPoints; ++n) {
            const auto add = [&](VF sum, std::size_t cell) HWY_ATTR {
                const float* const point = by_point[weights.point[n][cell]];
#if HWY_TARGET == HWY_SCALAR
                const VF values = hn::Load(f, point + lane % NodeSums::kFields);
#else
                const VF values = hn::LoadDup128(f, point);
#endif
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
    // All fields of a node, or, where a vector has one number, one after the other.
    const hn::CappedTag<float, NodeSums::kFields> of_node;
    using Node = hn::Vec<decltype(of_node)>;
    for (std::size_t field = 0; field < NodeSums::kFields; field += hn::Lanes(of_node)) {
        const auto corner = [&](std::size_t cell, std::size_t n)
                                HWY_ATTR { return hn::Load(of_node, sums[cell] + n * NodeSums::kFields + field); };
        const auto add = [&](std::size_t row, std::size_t column, Node sum) HWY_ATTR {
            float* const node = nodes + row * stride + column * NodeSums::kFields + field;
            hn::StoreU(hn::Add(hn::LoadU(of_node, node), sum), of_node, node);
        };
        // Corners of a cell: the second along x is the next, along y the one after.
        add(0, 0, corner(0, 0));
        add(0, 1, hn::Add(corner(0, 1), corner(1, 0)));
        add(0, 2, corner(1, 1));
        add(1, 0, hn::Add(corner(0, 2), corner(2, 0)));
        add(1, 1, hn::Add(hn::Add(hn::Add(corner(0, 3), corner(1, 2)), corner(2, 1)), corner(3, 0)));
        add(1, 2, hn::Add(corner(1, 3), corner(3, 1)));
        add(2, 0, corner(2, 2));
        add(2, 1, hn::Add(corner(2, 3), corner(3, 2)));
        add(2, 2, corner(3, 3));
    }
}

void AddNodes(const float* HWY_RESTRICT nodes, std::size_t count, float* HWY_RESTRICT surplus,
              float* HWY_RESTRICT gain0, float* HWY_RESTRICT gain1, float* HWY_RESTRICT gain2) {
    const F f;
    std::size_t n = 0;
    const auto add = [f](VF values, float* sums) HWY_ATTR { hn::StoreU(hn::Add(hn::LoadU(f, sums), values), f, sums); };
    for (; n + hn::Lanes(f) <= count; n += hn::Lanes(f)) {
        VF a;
        VF b;
        VF c;
        VF d;
        hn::LoadInterleaved4(f, nodes + 4 * n, a, b, c, d);
        add(a, surplus + n);
        add(b, gain0 + n);
        add(c, gain1 + n);
        add(d, gain2 + n);
    }
    for (; n < count; ++n) {
        surplus[n] += nodes[4 * n];
        gain0[n] += nodes[4 * n + 1];
        gain1[n] += nodes[4 * n + 2];
        gain2[n] += nodes[4 * n + 3];
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace stratum::voxelize
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stratum::voxelize {

HWY_EXPORT(PressLayer);
HWY_EXPORT(AddFields);
HWY_EXPORT(AddNodes);

void pressLayer(const PlanField& sides2, float radius, float straight, double settling_scale, PressedLayer& out) {
    HWY_DYNAMIC_DISPATCH(PressLayer)(sides2, radius, straight, settling_scale, out);
}

void addNodes(std::span<const TileSums::Node> nodes, float* surplus, float* gain0, float* gain1, float* gain2) {
    static_assert(sizeof(TileSums::Node) == 4 * sizeof(float));
    if (!nodes.empty()) HWY_DYNAMIC_DISPATCH(AddNodes)(&nodes[0].surplus, nodes.size(), surplus, gain0, gain1, gain2);
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

void NodeSums::add(const std::array<PlanField, kFields>& fields, float* nodes, std::size_t stride) const {
    HWY_DYNAMIC_DISPATCH(AddFields)(weights_, fields, nodes, stride);
}

NodeSums::Sums NodeSums::of(const std::array<PlanField, kFields>& fields) const {
    Sums sums{};
    add(fields, sums[0].data(), kSquareNodes * kFields);
    return sums;
}

}  // namespace stratum::voxelize
#endif  // HWY_ONCE
