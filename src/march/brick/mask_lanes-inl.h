// Mask64 of macro_cell.h in the lanes of a vector, for one Highway target at a time, hence the guard that toggles.
#if defined(STRATUM_MASK_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef STRATUM_MASK_LANES_INL_H
#undef STRATUM_MASK_LANES_INL_H
#else
#define STRATUM_MASK_LANES_INL_H
#endif

#include "march/brick/lanes-inl.h"
#include "march/brick/macro_cell.h"

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

#if STRATUM_WIDE_LANES
HWY_BEFORE_NAMESPACE();
namespace stratum::march {
namespace HWY_NAMESPACE {

/// A position in a Mask64, of whose coordinates only the low two bits count.
struct MaskPosition {
    VI v[3];

    /// Mask64::bit().
    HWY_INLINE VI bit() const {
        const VI three = whole(3);
        return hn::Or(hn::Or(hn::ShiftLeft<4>(hn::And(v[0], three)), hn::ShiftLeft<2>(hn::And(v[1], three))),
                      hn::And(v[2], three));
    }
};

/// Mask64::group() around a bit.
HWY_INLINE VI groupAround(VI bit) {
    return shiftedLeft(whole(static_cast<std::int64_t>(Mask64::group(0, 0, 0))), hn::And(bit, whole(42)));
}

/// Those of the bits of `mask` that a ray can come to from a position, it included: kAhead. `flip`: -1 along axes along
/// which the direction descends, else 0.
HWY_INLINE VI aheadIn(VI mask, const MaskPosition& from, const VI flip[3]) {
#if HWY_TARGET == HWY_AVX2
    VI index = from.bit();
    for (int axis = 0; axis < 3; ++axis) index = hn::Or(index, hn::And(flip[axis], whole(256 >> axis)));
    return hn::And(mask, gather(kAhead.data(), index));
#else
    // The product of three tables of eight entries, each of which fits in a vector: a gather takes five times as long.
    // The permutation reads three bits of its index: two of the position, and the direction's.
    for (int axis = 0; axis < 3; ++axis) {
        const VI index = hn::IfVecThenElse(whole(4), flip[axis], from.v[axis]);
        const VI table = hn::Load(DI(), kAheadAlong[static_cast<std::size_t>(axis)].data());
        const V bits = hn::TableLookupLanes(hn::BitCast(D(), table), hn::Indices512<double>{index.raw});
        mask = hn::And(mask, hn::BitCast(DI(), bits));
    }
    return mask;
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace stratum::march
HWY_AFTER_NAMESPACE();
#endif  // STRATUM_WIDE_LANES

#endif
