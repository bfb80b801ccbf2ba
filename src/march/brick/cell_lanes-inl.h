// Surface cells in the lanes of a vector, for one Highway target at a time, hence the guard that toggles: the roots of
// cell_root.h by the same operations in the same order; the corners of cells; and hits, collected until two vectors are
// full, since refining a root takes a dozen dependent operations and divisions, which is efficient only for full ones.
#if defined(STRATUM_CELL_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef STRATUM_CELL_LANES_INL_H
#undef STRATUM_CELL_LANES_INL_H
#else
#define STRATUM_CELL_LANES_INL_H
#endif

#include "march/brick/brick_grid.h"
#include "march/brick/brick_walk.h"
#include "march/brick/cell_root.h"
#include "march/brick/lanes-inl.h"
#include "trace/intersector.h"

#include <hwy/cache_control.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>

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

/// Reads the samples of a grid's bricks, of whichever kind.
class CornerReader {
public:
    explicit CornerReader(const BrickGrid& grid)
        : floats_(grid.values() == BrickValues::Float32 ? grid.floats() : nullptr), quanta_(grid.quanta()) {}

    /// The corners of cells whose first ones are at `index`.
    HWY_INLINE void read(VI index, V v[8]) const {
        pair(index, v[0], v[1]);
        pair(index + whole(BrickGrid::kStrideY), v[2], v[3]);
        pair(index + whole(BrickGrid::kStrideX), v[4], v[5]);
        pair(index + whole(BrickGrid::kStrideX + BrickGrid::kStrideY), v[6], v[7]);
    }
    /// Prefetches the corners of cells whose first ones are at `index`.
    HWY_INLINE void prefetch(const std::int64_t (&corners)[kLanes]) const {
        if (floats_ != nullptr)
            for (const std::int64_t corner : corners) prefetch(floats_ + corner);
        else
            for (const std::int64_t corner : corners) prefetch(quanta_ + corner);
    }

private:
    template <typename T>
    static HWY_INLINE void prefetch(const T* corner) {
        hwy::Prefetch(corner);
        hwy::Prefetch(corner + BrickGrid::kStrideX);
        hwy::Prefetch(corner + BrickGrid::kStrideY + 1);
        hwy::Prefetch(corner + BrickGrid::kStrideX + BrickGrid::kStrideY + 1);
    }
    // The sample at `index` and the one further along z, in one read of eight bytes.
    HWY_INLINE void pair(VI index, V& here, V& next) const {
        const DHalfU32 half;
        const auto eight = [](const auto* base, VI offset) HWY_ATTR {
            return hn::BitCast(DU(), hn::GatherOffset(DI(), reinterpret_cast<const std::int64_t*>(base), offset));
        };
        if (floats_ != nullptr) {
            const auto both = eight(floats_, hn::ShiftLeft<2>(index));
            here = hn::PromoteTo(D(), hn::BitCast(DF(), hn::TruncateTo(half, both)));
            next = hn::PromoteTo(D(), hn::BitCast(DF(), hn::TruncateTo(half, hn::ShiftRight<32>(both))));
        } else {
            const hn::RebindToSigned<DHalfU32> whole32;
            const auto both = hn::BitCast(whole32, hn::TruncateTo(half, eight(quanta_, hn::ShiftLeft<1>(index))));
            here = sampleOf(hn::PromoteTo(D(), hn::ShiftRight<16>(hn::ShiftLeft<16>(both))));
            next = sampleOf(hn::PromoteTo(D(), hn::ShiftRight<16>(both)));
        }
    }
    // march::sampleOf().
    static HWY_INLINE V sampleOf(V kept) {
        const D d;
        const V above = kept + hn::Set(d, 1.0);
        const V inside = hn::Min(above, hn::Set(d, kLeastInside));
        return hn::IfThenElse(hn::Lt(kept, hn::Zero(d)), inside, kept);
    }

    const float* floats_;
    const std::int16_t* quanta_;
};

/// Rays that have hit the surface: their roots, positions and normals are computed two vectors at a time.
class HitBatch {
public:
    HitBatch(const CornerReader& corners, const CellMap& map, std::span<const trace::Ray> rays, trace::Hit* hits)
        : corners_(corners), map_(map), rays_(rays), hits_(hits) {
        for (auto& field : field_)
            for (double& value : field) value = 0;
        for (std::int64_t& sample : sample_) sample = 0;
    }

    /// Of a lane: the ray's index, its t at the box, t since then where the cell is entered and left, and s of the root
    /// if it is known, or NaN.
    struct Crossing {
        V ray, start, in, out, s;
    };
    HWY_INLINE void push(unsigned lanes, const Crossing& c, const LaneCell& cell, VI sample) {
        const D d;
        const auto table = tableIndices(kTable.source[lanes]);
        const V fields[kFields] = {c.ray,        c.start,        c.in,           c.out,
                                   c.s,          cell.from.v[0], cell.from.v[1], cell.from.v[2],
                                   cell.to.v[0], cell.to.v[1],   cell.to.v[2]};
        for (int n = 0; n < kFields; ++n) hn::StoreU(hn::TableLookupLanes(fields[n], table), d, field_[n] + count_);
        hn::StoreU(hn::BitCast(DI(), hn::TableLookupLanes(hn::BitCast(d, sample), table)), DI(), sample_ + count_);
        count_ += std::popcount(lanes);
    }
    /// Finishes as many vectors of rays as are worthwhile if they are full. To be called before the next push().
    HWY_INLINE void finishFull() {
        const D d;
        if (count_ < kBatch) return;
        finish<kVectors>(kBatch);
        count_ -= kBatch;
        for (int n = 0; n < kFields; ++n) hn::StoreU(hn::LoadU(d, field_[n] + kBatch), d, field_[n]);
        hn::StoreU(hn::LoadU(DI(), sample_ + kBatch), DI(), sample_);
    }
    void flush() {
        if (count_ > kLanes)
            finish<kVectors>(count_);
        else if (count_ > 0)
            finish<1>(count_);
        count_ = 0;
    }

private:
    enum { kRay, kStart, kIn, kOut, kS, kFrom, kTo = kFrom + 3, kFields = kTo + 3 };

    static constexpr int kVectors = 2;
    static constexpr int kBatch = kVectors * kLanes;

    // BrickTracer::report(). Rows past `count` hold earlier rays, or zeros.
    template <int kCount>
    HWY_NOINLINE void finish(int count) const {
        const D d;
        LaneCell cell[kCount];
        LaneCubic cubic[kCount];
        V known[kCount];
        V s[kCount];
        M unknown[kCount];
        for (int k = 0; k < kCount; ++k) {
            const int first = k * kLanes;
            corners_.read(hn::LoadU(DI(), sample_ + first), cell[k].v);
            for (int axis = 0; axis < 3; ++axis) {
                cell[k].from.v[axis] = hn::LoadU(d, field_[kFrom + axis] + first);
                cell[k].to.v[axis] = hn::LoadU(d, field_[kTo + axis] + first);
            }
            cubic[k] = cubicOf(cell[k]);
            known[k] = hn::LoadU(d, field_[kS] + first);
            const unsigned there = count - first < kLanes ? (1U << (count - first)) - 1 : kAllLanes;
            unknown[k] = hn::AndNot(hn::Eq(known[k], known[k]), maskOf(there));
        }
        refine(cubic, unknown, s);
        for (int k = 0; k < kCount; ++k) {
            const int first = k * kLanes;
            report(cell[k], hn::IfThenElse(hn::Eq(known[k], known[k]), known[k], s[k]), first,
                   std::min(count - first, kLanes));
        }
    }

    // Rays of one vector.
    HWY_INLINE void report(const LaneCell& cell, V s, int first, int count) const {
        const D d;
        const auto load = [&](int field) HWY_ATTR { return hn::LoadU(d, field_[field] + first); };
        const V in = load(kIn);
        HWY_ALIGN double times[kLanes];
        HWY_ALIGN double normals[3][kLanes];
        hn::Store(load(kStart) + (in + s * (load(kOut) - in)), d, times);
        const Vec3 g = gradientOf(cell, s);
        V n[3];
        for (int axis = 0; axis < 3; ++axis)
            n[axis] = constant(map_.to_cells[axis][0]) * g.v[0] + constant(map_.to_cells[axis][1]) * g.v[1] +
                      constant(map_.to_cells[axis][2]) * g.v[2];
        const V length = hn::Sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        const unsigned flat = bitsOf(hn::Not(hn::Gt(length, hn::Zero(d))));
        for (int axis = 0; axis < 3; ++axis) hn::Store(n[axis] / length, d, normals[axis]);
        for (int lane = 0; lane < count; ++lane) {
            const auto index = static_cast<std::size_t>(field_[kRay][first + lane]);
            const trace::Ray& ray = rays_[index];
            trace::Hit& out = hits_[index];
            out.t = times[lane];
            out.position = ray.origin + out.t * ray.direction;
            out.normal = {normals[0][lane], normals[1][lane], normals[2][lane]};
            if ((flat >> lane & 1) != 0) out.normal = -ray.direction;
        }
    }

    const CornerReader& corners_;
    const CellMap& map_;
    const std::span<const trace::Ray> rays_;
    trace::Hit* const hits_;
    int count_ = 0;
    HWY_ALIGN double field_[kFields][kBatch + kLanes];
    HWY_ALIGN std::int64_t sample_[kBatch + kLanes];
};

}  // namespace HWY_NAMESPACE
}  // namespace stratum::march
HWY_AFTER_NAMESPACE();
#endif  // STRATUM_WIDE_LANES

#endif
