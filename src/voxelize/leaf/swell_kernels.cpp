#include "voxelize/leaf/swell_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "voxelize/leaf/swell_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "voxelize/leaf/path_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace stratum::voxelize {
namespace HWY_NAMESPACE {

void NodeRamps(const PlanField& q, float per_unit, float first, std::span<PlanField> ramps) {
    const F f;
    const VF zero = hn::Zero(f);
    const VF one = hn::Set(f, 1.0F);
    forEachVector([&](std::size_t c) HWY_ATTR {
        const VF at = hn::Add(hn::Mul(hn::Load(f, q.v + c), hn::Set(f, per_unit)), hn::Set(f, first));
        for (std::size_t n = 0; n < ramps.size(); ++n) {
            // nodeShare()
            const VF t = hn::Min(hn::Max(hn::Sub(at, hn::Set(f, static_cast<float>(n))), zero), one);
            const VF slope = hn::Sub(hn::Set(f, 3.0F), hn::Add(t, t));
            hn::Store(hn::Mul(hn::Mul(t, t), slope), f, ramps[n].v + c);
        }
    });
}

void BetweenNodes(std::span<const PlanField> ramps_x, std::span<const PlanField> ramps_y,
                  const float* HWY_RESTRICT steps, float scale, PlanField& values) {
    const F f;
    const auto alongRow = [&](std::size_t row, std::size_t c) HWY_ATTR {
        const float* at = steps + row * (ramps_x.size() + 1);
        VF value = hn::Set(f, at[0]);
        for (std::size_t n = 0; n < ramps_x.size(); ++n)
            value = hn::Add(value, hn::Mul(hn::Load(f, ramps_x[n].v + c), hn::Set(f, at[n + 1])));
        return value;
    };
    forEachVector([&](std::size_t c) HWY_ATTR {
        VF before = alongRow(0, c);
        VF value = before;
        for (std::size_t n = 0; n < ramps_y.size(); ++n) {
            const VF next = alongRow(n + 1, c);
            value = hn::Add(value, hn::Mul(hn::Load(f, ramps_y[n].v + c), hn::Sub(next, before)));
            before = next;
        }
        hn::Store(hn::Mul(value, hn::Set(f, scale)), f, values.v + c);
    });
}

void LowerByCrown(const PlanField& share, const PlanField& nearest, float crown, float radius, PlanField& rise) {
    const F f;
    const VF most = hn::Set(f, radius);
    const VF per_across2 = hn::Set(f, crown / (4 * radius * radius));
    forEachVector([&](std::size_t c) HWY_ATTR {
        // crownDepth()
        const VF d = hn::Min(hn::Max(hn::Load(f, nearest.v + c), hn::Neg(most)), most);
        const VF across = hn::Add(d, most);
        const VF depth = hn::Mul(hn::Mul(across, across), per_across2);
        const VF by = hn::Mul(hn::Load(f, share.v + c), depth);
        hn::Store(hn::Sub(hn::Load(f, rise.v + c), by), f, rise.v + c);
    });
}

}  // namespace HWY_NAMESPACE
}  // namespace stratum::voxelize
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stratum::voxelize {

HWY_EXPORT(NodeRamps);
HWY_EXPORT(BetweenNodes);
HWY_EXPORT(LowerByCrown);

void nodeRamps(const PlanField& q, float per_unit, float first, std::span<PlanField> ramps) {
    HWY_DYNAMIC_DISPATCH(NodeRamps)(q, per_unit, first, ramps);
}
void betweenNodes(std::span<const PlanField> ramps_x, std::span<const PlanField> ramps_y, std::span<float> nodes,
                  float scale, PlanField& values) {
    // Of each row the first node, and the steps from there on.
    const std::size_t width = ramps_x.size() + 1;
    for (std::size_t first = 0; first < nodes.size(); first += width)
        for (std::size_t n = first + width - 1; n > first; --n) nodes[n] -= nodes[n - 1];
    HWY_DYNAMIC_DISPATCH(BetweenNodes)(ramps_x, ramps_y, nodes.data(), scale, values);
}
void lowerByCrown(const PlanField& share, const PlanField& nearest, float crown, float radius, PlanField& rise) {
    HWY_DYNAMIC_DISPATCH(LowerByCrown)(share, nearest, crown, radius, rise);
}

}  // namespace stratum::voxelize
#endif  // HWY_ONCE
