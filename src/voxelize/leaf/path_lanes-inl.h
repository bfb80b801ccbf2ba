// A column of samples in the lanes of vectors, and the distance to a path, for one Highway target at a time, hence the
// guard that toggles. Every operation is one that IEEE 754 rounds exactly; see leaf_kernels.h.
#if defined(STRATUM_PATH_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef STRATUM_PATH_LANES_INL_H
#undef STRATUM_PATH_LANES_INL_H
#else
#define STRATUM_PATH_LANES_INL_H
#endif

#include "voxelize/beads/local_path.h"
#include "voxelize/leaf/leaf_kernels.h"

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace stratum::voxelize {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// At most 16 lanes, so that a column is whole vectors on every target.
using F = hn::CappedTag<float, 16>;
using U = hn::RebindToUnsigned<F>;
using VF = hn::Vec<F>;

template <typename Body>
HWY_INLINE void forEachVector(const Body& body) {
    const F f;
    for (std::size_t c = 0; c < kColumnSamples; c += hn::Lanes(f)) body(c);
}

HWY_INLINE VF dot(VF ax, VF ay, VF bx, VF by) { return hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)); }

// Distance to a line segment, its square, or to the line where the segment passes all samples.
HWY_INLINE VF across(const LocalLine& line, VF qx, VF qy) {
    const F f;
    return hn::Add(hn::Set(f, line.n0), dot(hn::Set(f, line.nx), hn::Set(f, line.ny), qx, qy));
}
HWY_INLINE VF along(const LocalLine& line, VF qx, VF qy) {
    const F f;
    return dot(hn::Set(f, line.ux), hn::Set(f, line.uy), qx, qy);
}
HWY_INLINE VF beyond(VF s, float lo, float hi) {
    const F f;
    return hn::Max(hn::Max(hn::Sub(hn::Set(f, lo), s), hn::Sub(s, hn::Set(f, hi))), hn::Zero(f));
}
HWY_INLINE VF distance(const LocalLine& line, VF qx, VF qy) {
    const VF n = across(line, qx, qy);
    if (line.spans) return hn::Abs(n);
    const VF e = beyond(along(line, qx, qy), line.lo, line.hi);
    return hn::Sqrt(dot(n, e, n, e));
}

// The distance to the flat of a path.
HWY_INLINE VF offset(const LocalLine& line, VF qx, VF qy) {
    const F f;
    return hn::Sub(distance(line, qx, qy), hn::Set(f, line.half_flat));
}

// Of a tapered path also the way back along it from the nearest section, and the distance from the path there.
struct TaperPoint {
    VF d, past, rho;
};
HWY_INLINE TaperPoint nearest(const LocalTaper& taper, VF qx, VF qy) {
    const F f;
    const VF n = across(taper.line, qx, qy);
    const VF s = along(taper.line, qx, qy);
    const VF leant = hn::Add(s, hn::Mul(hn::Set(f, taper.lean), hn::Abs(n)));
    const VF at = hn::Min(hn::Max(leant, hn::Set(f, taper.line.lo)), hn::Set(f, taper.line.hi));
    const VF flat =
        hn::Add(hn::Set(f, taper.flat), hn::Mul(hn::Set(f, taper.slope), hn::Sub(at, hn::Set(f, taper.flat_at))));
    const VF past = hn::Sub(s, at);
    const VF rho = hn::Sqrt(dot(n, past, n, past));
    return {hn::Sub(rho, flat), past, rho};
}
HWY_INLINE VF offset(const LocalTaper& taper, VF qx, VF qy) { return nearest(taper, qx, qy).d; }

// Where the nearest point of the circle lies on the arc, which is not full.
HWY_INLINE hn::Mask<F> withinSweep(const LocalArc& arc, VF qx, VF qy) {
    const F f;
    const VF past_start = hn::Add(hn::Set(f, arc.s0), dot(hn::Set(f, arc.sx), hn::Set(f, arc.sy), qx, qy));
    const VF before_end = hn::Add(hn::Set(f, arc.t0), dot(hn::Set(f, arc.tx), hn::Set(f, arc.ty), qx, qy));
    const VF wedge = arc.wide ? hn::Max(past_start, before_end) : hn::Min(past_start, before_end);
    return hn::Ge(wedge, hn::Zero(f));
}

HWY_INLINE VF distance(const LocalArc& arc, VF qx, VF qy) {
    const F f;
    VF on_circle;
    if (arc.near_center) {
        const VF vx = hn::Add(qx, hn::Set(f, arc.vx));
        const VF vy = hn::Add(qy, hn::Set(f, arc.vy));
        on_circle = hn::Abs(hn::Sub(hn::Sqrt(dot(vx, vy, vx, vy)), hn::Set(f, arc.radius)));
    } else {
        const VF eq = dot(hn::Set(f, arc.ex), hn::Set(f, arc.ey), qx, qy);
        const VF k = hn::Set(f, arc.k);
        const VF t = hn::Add(hn::Add(eq, eq), hn::Mul(k, dot(qx, qy, qx, qy)));
        const VF one = hn::Set(f, 1.0f);
        const VF root = hn::Sqrt(hn::Add(one, hn::Mul(k, t)));
        on_circle = hn::Abs(hn::Add(hn::Set(f, arc.rho0), hn::Div(t, hn::Add(one, root))));
    }
    if (arc.full) return on_circle;
    const VF ax = hn::Sub(qx, hn::Set(f, arc.start_x));
    const VF ay = hn::Sub(qy, hn::Set(f, arc.start_y));
    const VF bx = hn::Sub(qx, hn::Set(f, arc.end_x));
    const VF by = hn::Sub(qy, hn::Set(f, arc.end_y));
    const VF to_ends = hn::Sqrt(hn::Min(dot(ax, ay, ax, ay), dot(bx, by, bx, by)));
    return hn::IfThenElse(withinSweep(arc, qx, qy), on_circle, to_ends);
}
HWY_INLINE VF offset(const LocalArc& arc, VF qx, VF qy) {
    const F f;
    return hn::Sub(distance(arc, qx, qy), hn::Set(f, arc.half_flat));
}

}  // namespace HWY_NAMESPACE
}  // namespace stratum::voxelize
HWY_AFTER_NAMESPACE();

#endif  // STRATUM_PATH_LANES_INL_H
