#include "voxelize/leaf/owner_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "voxelize/leaf/owner_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "voxelize/leaf/path_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace stratum::voxelize {
namespace HWY_NAMESPACE {

void TakeNearer(const OwnedLayer& layer, PlanField& least, PlanOwners& owners) {
    const F f;
    const U u;
    const VF zero = hn::Zero(f);
    forEachVector([&](std::size_t c) HWY_ATTR {
        VF over = hn::Set(f, layer.over);
        if (layer.rise != nullptr) {
            const VF moved = hn::Sub(hn::Set(f, layer.dz), hn::Load(f, layer.rise->v + c));
            over = hn::Sub(hn::Max(hn::Min(moved, hn::Set(f, 2 * layer.dz)), zero), hn::Set(f, layer.half_side));
        }
        const VF above = hn::Max(over, zero);
        const VF square = hn::Add(hn::Load(f, layer.sides2->v + c), hn::Mul(above, above));
        VF distance = hn::Sub(hn::Sqrt(square), hn::Set(f, layer.radius));
        if (layer.d != nullptr) distance = hn::Add(distance, hn::Min(hn::Max(hn::Load(f, layer.d->v + c), over), zero));
        const VF before = hn::Load(f, least.v + c);
        const auto rank = hn::Load(u, layer.owners->v + c);
        const auto owner = hn::Load(u, owners.v + c);
        const auto lower = hn::RebindMask(f, hn::Lt(rank, owner));
        const auto nearer = hn::Or(hn::Lt(distance, before), hn::And(hn::Eq(distance, before), lower));
        hn::Store(hn::IfThenElse(nearer, distance, before), f, least.v + c);
        hn::Store(hn::IfThenElse(hn::RebindMask(u, nearer), rank, owner), u, owners.v + c);
    });
}

}  // namespace HWY_NAMESPACE
}  // namespace stratum::voxelize
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stratum::voxelize {

HWY_EXPORT(TakeNearer);

void takeNearer(const OwnedLayer& layer, PlanField& least, PlanOwners& owners) {
    HWY_DYNAMIC_DISPATCH(TakeNearer)(layer, least, owners);
}

}  // namespace stratum::voxelize
#endif  // HWY_ONCE
