// cell_root.h in the lanes of a vector: the same operations in the same order, for one Highway target at a time, hence
// the guard that toggles.
#if defined(STRATUM_CELL_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef STRATUM_CELL_LANES_INL_H
#undef STRATUM_CELL_LANES_INL_H
#else
#define STRATUM_CELL_LANES_INL_H
#endif

#include "march/brick/cell_root.h"
#include "march/brick/lanes-inl.h"

#include <bit>

#if STRATUM_WIDE_LANES
HWY_BEFORE_NAMESPACE();
namespace stratum::march {
namespace HWY_NAMESPACE {

/// A cell in every lane, and the segment of a ray in it: values at the corners, index x << 2 | y << 1 | z, and the
/// entry and exit points in [0, 1]^3.
struct LaneCell {
    V v[8];
    Vec3 from, to;
};

/// interpolate().
HWY_INLINE V interpolated(const V v[8], const Vec3& p) {
    const V one = constant(1);
    const V x1 = p.v[0];
    const V x0 = one - x1;
    const V y1 = p.v[1];
    const V y0 = one - y1;
    const V y0z0 = v[0] * x0 + v[4] * x1;
    const V y0z1 = v[1] * x0 + v[5] * x1;
    const V y1z0 = v[2] * x0 + v[6] * x1;
    const V y1z1 = v[3] * x0 + v[7] * x1;
    return (y0z0 * y0 + y1z0 * y1) * (one - p.v[2]) + (y0z1 * y0 + y1z1 * y1) * p.v[2];
}

/// SegmentCubic.
struct LaneCubic {
    V c0, c1, c2, c3, end;
};
HWY_INLINE LaneCubic cubicOf(const LaneCell& cell) {
    const V* v = cell.v;
    const Vec3& from = cell.from;
    const Vec3& to = cell.to;
    const V c0 = interpolated(v, from);
    const V end = interpolated(v, to);
    const V kx = v[4] - v[0];
    const V ky = v[2] - v[0];
    const V kz = v[1] - v[0];
    const V kxy = v[6] - v[4] - ky;
    const V kzx = v[5] - v[4] - kz;
    const V kyz = v[3] - v[2] - kz;
    const V kxyz = v[7] - v[6] - v[5] + v[4] - kyz;
    const V a = to.v[0] - from.v[0];
    const V b = to.v[1] - from.v[1];
    const V c = to.v[2] - from.v[2];
    const V fx = from.v[0];
    const V fy = from.v[1];
    const V fz = from.v[2];
    const V c3 = kxyz * a * b * c;
    const V c2 = a * b * (kxy + kxyz * fz) + b * c * (kyz + kxyz * fx) + a * c * (kzx + kxyz * fy);
    const V c1 = a * (kx + kxy * fy + kzx * fz + kxyz * fy * fz) + b * (ky + kxy * fx + kyz * fz + kxyz * fx * fz) +
                 c * (kz + kzx * fx + kyz * fy + kxyz * fx * fy);
    return {c0, c1, c2, c3, end};
}

/// refineRoot() in the bracket [0, 1], of kCount vectors at once: a step waits for the one before, so that two take
/// little longer than one.
template <int kCount>
HWY_INLINE void refine(const LaneCubic (&f)[kCount], M (&active)[kCount], V (&root)[kCount]) {
    const D d;
    const V zero = hn::Zero(d);
    const V half = constant(0.5);
    const V last_step = constant(kRootStep);
    const V rounding = constant(kRootRounding);
    V slope3[kCount];
    V slope2[kCount];
    M in_low[kCount];
    V low[kCount];
    V high[kCount];
    V s[kCount];
    for (int k = 0; k < kCount; ++k) {
        slope3[k] = constant(3) * f[k].c3;
        slope2[k] = constant(2) * f[k].c2;
        in_low[k] = hn::Lt(f[k].c0, zero);
        low[k] = zero;
        high[k] = constant(1);
        const V chord = f[k].c0 / (f[k].c0 - f[k].end);
        s[k] = clampTo(chord, constant(kRootMargin), constant(1 - kRootMargin));
        root[k] = s[k];
    }
    for (int n = 0; n < kRootSteps; ++n) {
        M any = active[0];
        for (int k = 0; k < kCount; ++k) {
            const V value = ((f[k].c3 * s[k] + f[k].c2) * s[k] + f[k].c1) * s[k] + f[k].c0;
            const V rise = slope3[k] * s[k];
            const V slope = (rise + slope2[k]) * s[k] + f[k].c1;
            const V step = value * slope / (slope * slope - value * (rise + f[k].c2));
            const M exact = hn::Eq(value, zero);
            const M before = hn::Not(hn::Xor(hn::Lt(value, zero), in_low[k]));
            low[k] = hn::IfThenElse(before, s[k], low[k]);
            high[k] = hn::IfThenElse(before, high[k], s[k]);
            const V halley = s[k] - step;
            const M inside =
                hn::And(hn::Ne(step, zero), hn::And(hn::Ge(halley, low[k] - hn::IfThenZeroElse(before, rounding)),
                                                    hn::Le(halley, high[k] + hn::IfThenElseZero(before, rounding))));
            const V middle = half * (low[k] + high[k]);
            const M ended = hn::Or(hn::Eq(middle, low[k]), hn::Eq(middle, high[k]));
            V next = hn::IfThenElse(inside, clampTo(halley, low[k], high[k]), middle);
            const M done =
                hn::Or(exact, hn::Or(hn::And(inside, hn::Le(hn::Abs(step), last_step)), hn::AndNot(inside, ended)));
            next = hn::IfThenElse(exact, s[k], next);
            root[k] = hn::IfThenElse(active[k], next, root[k]);
            active[k] = hn::AndNot(done, active[k]);
            any = k == 0 ? active[k] : hn::Or(any, active[k]);
            s[k] = next;
        }
        if (hn::AllFalse(d, any)) break;
    }
}

/// gradient() at s along the segment.
HWY_INLINE Vec3 gradientOf(const LaneCell& cell, V s) {
    const V one = constant(1);
    const V* v = cell.v;
    V q[3];
    V r[3];
    for (int axis = 0; axis < 3; ++axis) {
        q[axis] = cell.from.v[axis] + s * (cell.to.v[axis] - cell.from.v[axis]);
        r[axis] = one - q[axis];
    }
    return {
        {r[1] * (r[2] * (v[4] - v[0]) + q[2] * (v[5] - v[1])) + q[1] * (r[2] * (v[6] - v[2]) + q[2] * (v[7] - v[3])),
         r[0] * (r[2] * (v[2] - v[0]) + q[2] * (v[3] - v[1])) + q[0] * (r[2] * (v[6] - v[4]) + q[2] * (v[7] - v[5])),
         r[0] * (r[1] * (v[1] - v[0]) + q[1] * (v[3] - v[2])) + q[0] * (r[1] * (v[5] - v[4]) + q[1] * (v[7] - v[6]))}};
}

/// Cells whose sign may change more than once along the ray are rare: the scalar code solves them.
template <bool kAny>
HWY_NOINLINE unsigned solveOneByOne(unsigned rare, const LaneCell& cell, V& s) {
    const D d;
    HWY_ALIGN double corners[8][kLanes];
    HWY_ALIGN double ends[6][kLanes];
    HWY_ALIGN double roots[kLanes];
    for (int n = 0; n < 8; ++n) hn::Store(cell.v[n], d, corners[n]);
    for (int axis = 0; axis < 3; ++axis) {
        hn::Store(cell.from.v[axis], d, ends[axis]);
        hn::Store(cell.to.v[axis], d, ends[3 + axis]);
    }
    hn::Store(s, d, roots);
    unsigned hit = 0;
    for (unsigned rest = rare; rest != 0; rest &= rest - 1) {
        const int lane = std::countr_zero(rest);
        Corners values;
        for (std::size_t n = 0; n < 8; ++n) values[n] = corners[n][lane];
        const SegmentCubic field(values, {ends[0][lane], ends[1][lane], ends[2][lane]},
                                 {ends[3][lane], ends[4][lane], ends[5][lane]});
        const auto bracket = firstCrossing(field);
        if (!bracket) continue;
        hit |= 1U << lane;
        if constexpr (!kAny) roots[lane] = refineRoot(field, *bracket);
    }
    s = hn::Load(d, roots);
    return hit;
}

}  // namespace HWY_NAMESPACE
}  // namespace stratum::march
HWY_AFTER_NAMESPACE();
#endif  // STRATUM_WIDE_LANES

#endif
