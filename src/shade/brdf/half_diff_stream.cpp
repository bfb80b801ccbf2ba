#include "shade/brdf/half_diff_table.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shade/brdf/half_diff_stream.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "shade/angle_lanes-inl.h"

#ifndef STRATUM_HALF_DIFF_STREAM_TYPES
#define STRATUM_HALF_DIFF_STREAM_TYPES
namespace stratum::shade {
namespace {

constexpr std::size_t kBatch = 64;  // whole vectors on every target, enough cache misses to be served together

/// Pairs of directions, and where each falls into the table.
struct alignas(64) PairBatch {
    std::array<glm::vec3, kBatch> wo, wi;
    std::array<std::int32_t, kBatch> low, high;        // cells along the rotation, in the row of the lower angles
    std::array<float, kBatch> half, difference, turn;  // weights of the higher angles
};

}  // namespace
}  // namespace stratum::shade
#endif

HWY_BEFORE_NAMESPACE();
namespace stratum::shade {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, 16>;
using I = hn::RebindToSigned<F>;
using V = hn::Vec<F>;
using VI = hn::Vec<I>;

HWY_INLINE V set(float v) { return hn::Set(F(), v); }

struct Vec3 {
    V x, y, z;
};
HWY_INLINE Vec3 load(const glm::vec3* from) {
    Vec3 v;
    hn::LoadInterleaved3(F(), &from->x, v.x, v.y, v.z);
    return v;
}
HWY_INLINE V squared(const Vec3& v) {
    return hn::Add(hn::Add(hn::Mul(v.x, v.x), hn::Mul(v.y, v.y)), hn::Mul(v.z, v.z));
}

// The cell below a position, and the weight of the next one.
struct Split {
    VI low;
    V weight;
};
HWY_INLINE Split split(V position, int count) {
    const V clamped = hn::Min(hn::Max(position, set(0.0f)), set(static_cast<float>(count - 1)));
    const V low = hn::Min(hn::Floor(clamped), set(static_cast<float>(count - 2)));
    return {hn::ConvertTo(I(), low), hn::Sub(clamped, low)};
}

// The first half of HalfDiffTable::at, step by step, but for the arctangents.
void Place(std::size_t count, PairBatch& b) {
    const F f;
    const I i;
    constexpr double kQuarters = 4.0;  // arcTurns in quarters of a turn
    for (std::size_t n = 0; n < count; n += hn::Lanes(f)) {
        const Vec3 wo = load(&b.wo[n]);
        const Vec3 wi = load(&b.wi[n]);
        const Vec3 sum{hn::Add(wo.x, wi.x), hn::Add(wo.y, wi.y), hn::Add(wo.z, wi.z)};
        const V half = set(0.5f);
        const Vec3 d{hn::Mul(half, hn::Sub(wi.x, wo.x)), hn::Mul(half, hn::Sub(wi.y, wo.y)),
                     hn::Mul(half, hn::Sub(wi.z, wo.z))};
        const V length = hn::Sqrt(squared(sum));
        const V inverse = hn::Div(set(1.0f), length);
        const Vec3 h{hn::Mul(sum.x, inverse), hn::Mul(sum.y, inverse), hn::Mul(sum.z, inverse)};
        const V s = hn::Sqrt(hn::Add(hn::Mul(h.x, h.x), hn::Mul(h.y, h.y)));
        const V th = arcTurns(f, s, h.z, kQuarters);
        const V td = arcTurns(f, hn::Sqrt(squared(d)), hn::Mul(half, length), kQuarters);
        V along = hn::Sub(hn::Div(hn::Mul(hn::Add(hn::Mul(d.x, h.x), hn::Mul(d.y, h.y)), h.z), s), hn::Mul(d.z, s));
        V across = hn::Div(hn::Sub(hn::Mul(d.y, h.x), hn::Mul(d.x, h.y)), s);
        const V zero = hn::Zero(f);
        const auto flip = hn::Or(hn::Lt(across, zero), hn::And(hn::Eq(across, zero), hn::Lt(along, zero)));
        across = hn::IfThenElse(flip, hn::Neg(across), across);
        along = hn::IfThenElse(flip, hn::Neg(along), along);
        const V pd = hn::IfThenElseZero(hn::Gt(s, zero), arcTurns(f, across, along, kQuarters));

        const Split x = split(hn::Sub(hn::Mul(hn::Sqrt(th), set(HalfDiffTable::kHalf)), half), HalfDiffTable::kHalf);
        const Split y = split(hn::Sub(hn::Mul(td, set(HalfDiffTable::kDiff)), half), HalfDiffTable::kDiff);
        const V turns = set(HalfDiffTable::kTurn);
        V z = hn::Sub(hn::Mul(pd, hn::Mul(half, turns)), half);
        z = hn::IfThenElse(hn::Lt(z, zero), hn::Add(z, turns), z);
        const V k0 = hn::Min(hn::Floor(z), set(HalfDiffTable::kTurn - 1));
        const V next = hn::Add(k0, set(1.0f));
        const V k1 = hn::IfThenZeroElse(hn::Eq(next, turns), next);
        const VI row =
            hn::Mul(hn::Add(hn::Mul(x.low, hn::Set(i, HalfDiffTable::kDiff)), y.low), hn::Set(i, HalfDiffTable::kTurn));
        hn::Store(hn::Add(row, hn::ConvertTo(i, k0)), i, &b.low[n]);
        hn::Store(hn::Add(row, hn::ConvertTo(i, k1)), i, &b.high[n]);
        hn::Store(x.weight, f, &b.half[n]);
        hn::Store(y.weight, f, &b.difference[n]);
        hn::Store(hn::Sub(z, k0), f, &b.turn[n]);
    }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace stratum::shade
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stratum::shade {
namespace {
HWY_EXPORT(Place);
}  // namespace

void HalfDiffTable::at(std::span<const glm::vec3> wo, std::span<const glm::vec3> wi, std::span<Color> values) const {
    constexpr std::size_t kNextDifference = kTurn;
    constexpr std::size_t kNextHalf = std::size_t{kDiff} * kTurn;
    PairBatch b;
    // The lanes behind the last pair must be directions, too.
    b.wo.fill({0.0f, 0.0f, 1.0f});
    b.wi = b.wo;
    for (std::size_t first = 0; first < wo.size(); first += kBatch) {
        const std::size_t count = std::min(kBatch, wo.size() - first);
        std::copy_n(wo.begin() + static_cast<std::ptrdiff_t>(first), count, b.wo.begin());
        std::copy_n(wi.begin() + static_cast<std::ptrdiff_t>(first), count, b.wi.begin());
        HWY_DYNAMIC_DISPATCH(Place)(count, b);
        const Color* const cells = values_.data();
        for (std::size_t n = 0; n < count; ++n)
            for (const std::size_t row : {std::size_t{0}, kNextDifference, kNextHalf, kNextHalf + kNextDifference})
                hwy::Prefetch(cells + static_cast<std::size_t>(b.low[n]) + row);
        for (std::size_t n = 0; n < count; ++n) {
            const auto row = [&](std::size_t from) {
                const Color* c = cells + from;
                return (1.0f - b.turn[n]) * c[b.low[n]] + b.turn[n] * c[b.high[n]];
            };
            const float y = b.difference[n];
            values[first + n] = (1.0f - b.half[n]) * ((1.0f - y) * row(0) + y * row(kNextDifference)) +
                                b.half[n] * ((1.0f - y) * row(kNextHalf) + y * row(kNextHalf + kNextDifference));
        }
    }
}

}  // namespace stratum::shade
#endif  // HWY_ONCE
