#include "shade/environment/map_stream.h"

#include "shade/environment/normal_bins.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shade/environment/map_stream.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef STRATUM_MAP_STREAM_TYPES
#define STRATUM_MAP_STREAM_TYPES
namespace stratum::shade {
namespace {

// Surfaces at a time: whole vectors on every target, enough cache misses to be served together, and small enough for
// the first-level cache.
constexpr std::size_t kBatch = 64;
constexpr double kTurn = 2.0 * std::numbers::pi;  // radians
template <typename T>
using Batch = std::array<T, kBatch>;

struct alignas(64) MapBatch {
    Batch<double> u, v;     // draws
    Batch<double> bin;      // of the normals
    Batch<double> x, y;     // positions on the map, [0, 1)
    Batch<double> density;  // there, per unit of area
    Batch<double> dx, dy, dz;
    Batch<double> sine;  // of the polar angle
    Batch<float> r, g, b;
};

}  // namespace
}  // namespace stratum::shade
#endif

HWY_BEFORE_NAMESPACE();
namespace stratum::shade {
namespace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
// Doubles, as in the scalar functions: the position in a cell of a large map is in the digits of a draw below those
// that select the cell. Whole numbers in them are indices.
using D = hn::CappedTag<double, 8>;
using F = hn::Rebind<float, D>;
using I = hn::Rebind<std::int32_t, D>;
using VD = hn::Vec<D>;
using VF = hn::Vec<F>;
using M = hn::Mask<D>;

HWY_INLINE VD set(double v) { return hn::Set(D(), v); }
HWY_INLINE VD whole(std::size_t v) { return set(static_cast<double>(v)); }

HWY_INLINE VF gatherFloats(const float* HWY_RESTRICT from, VD index) {
    return hn::GatherIndex(F(), from, hn::DemoteTo(I(), index));
}
HWY_INLINE VD gather(const float* HWY_RESTRICT from, VD index) { return hn::PromoteTo(D(), gatherFloats(from, index)); }
HWY_INLINE VD gather(const double* HWY_RESTRICT from, VD index) {
    return hn::GatherIndex(D(), from, hn::PromoteTo(hn::RebindToSigned<D>(), hn::DemoteTo(I(), index)));
}

// The interval of a running sum, from sums[begin] on, in which u times its end falls: find() of one draw.
struct Found {
    VD index, offset;
};
template <typename T>
HWY_INLINE Found find(const T* HWY_RESTRICT sums, VD begin, std::size_t count, VD u) {
    const VD target = hn::Mul(u, gather(sums, hn::Add(begin, whole(count - 1))));
    VD first = begin;
    for (std::size_t left = count; left > 1;) {
        const std::size_t half = left / 2;
        const M go = hn::Le(gather(sums, hn::Add(first, whole(half - 1))), target);
        first = hn::IfThenElse(go, hn::Add(first, whole(half)), first);
        left -= half;
    }
    const VD before = hn::Max(hn::Sub(first, set(1.0)), begin);
    const VD below = hn::IfThenZeroElse(hn::Eq(first, begin), gather(sums, before));
    const VD width = hn::Sub(gather(sums, first), below);
    const VD offset = hn::Min(hn::Max(hn::Div(hn::Sub(target, below), width), set(0.0)), set(kBelowOne));
    // An empty interval has width 0, and the offset in it must not become an index.
    return {hn::Sub(first, begin), hn::IfThenElseZero(hn::Gt(width, set(0.0)), offset)};
}

HWY_INLINE VD mix(VD w, VD a, VD b) { return hn::Add(hn::Mul(hn::Sub(set(1.0), w), a), hn::Mul(w, b)); }

// drawLinear of one draw.
HWY_INLINE VD drawLinear(VD a, VD b, VD u) {
    const VD sum = hn::Add(a, b);
    const VD below = hn::Mul(hn::Mul(hn::Sub(set(1.0), u), a), a);
    const VD above = hn::Mul(hn::Mul(u, b), b);
    const VD x = hn::Div(hn::Mul(u, sum), hn::Add(a, hn::Sqrt(hn::Add(below, above))));
    return hn::IfThenElse(hn::Gt(sum, set(0.0)), hn::Min(hn::Max(x, set(0.0)), set(kBelowOne)), u);
}

struct Corners {
    VD w00, w10, w01, w11;
    HWY_INLINE VD at(VD x, VD y) const { return mix(y, mix(x, w00, w10), mix(x, w01, w11)); }
};
HWY_INLINE Corners corners(const BilinearDistribution::View& t, VD column, VD row) {
    const VD columns = set(t.columns);
    const VD next = hn::Add(column, set(1.0));
    const VD right = hn::IfThenZeroElse(hn::Eq(next, columns), next);
    const VD above = hn::Mul(hn::Max(hn::Sub(row, set(1.0)), set(0.0)), columns);
    const VD below = hn::Mul(hn::Min(row, set(t.rows - 1)), columns);
    return {gather(t.weights, hn::Add(above, column)), gather(t.weights, hn::Add(above, right)),
            gather(t.weights, hn::Add(below, column)), gather(t.weights, hn::Add(below, right))};
}

// BilinearDistribution::scale of one cell.
HWY_INLINE VD scale(const BilinearDistribution::View& t, VD bin, VD block_row, VD block_column, VD row) {
    const VD zero = set(0.0);
    const VD scales = hn::Add(hn::Mul(bin, whole(t.block_rows)), block_row);
    const VD row_scale = gather(t.row_scales, scales);
    const VD sums = hn::Mul(scales, whole(t.block_columns));
    const VF before = gatherFloats(t.block_sums, hn::Add(sums, hn::Max(hn::Sub(block_column, set(1.0)), zero)));
    const VF here = gatherFloats(t.block_sums, hn::Add(sums, block_column));
    const VD share =
        hn::IfThenElse(hn::Eq(block_column, zero), hn::PromoteTo(D(), here), hn::PromoteTo(D(), hn::Sub(here, before)));
    const M some = hn::And(hn::Gt(row_scale, zero), hn::Gt(share, zero));
    // Of a table of lamps most blocks are empty.
    if (hn::AllFalse(D(), some)) return zero;
    const VD block = gather(t.block_weights, hn::Add(hn::Mul(block_row, whole(t.block_columns)), block_column));
    VD result = hn::Div(hn::Mul(row_scale, share), block);
    result = hn::Mul(result, gather(t.sines, row));
    result = hn::Mul(hn::Mul(result, set(t.columns)), set(t.rows));
    return hn::IfThenElseZero(some, result);
}

HWY_INLINE VD binOf(const BilinearDistribution::View& t, const MapBatch& b, std::size_t n) {
    return t.bins == 1 ? set(0.0) : hn::Load(D(), &b.bin[n]);
}

// BilinearDistribution::sample. Each search is done for the whole batch before the next one, so that the loads of many
// draws are served together.
void Draw(const BilinearDistribution::View& t, MapBatch& b) {
    const D d;
    alignas(64) Batch<double> block_row, block_column, u, v;
    for (std::size_t n = 0; n < kBatch; n += hn::Lanes(d)) {
        const VD first_row = hn::Mul(binOf(t, b, n), whole(t.block_rows));
        const Found row = find(t.row_sums, first_row, t.block_rows, hn::Load(d, &b.v[n]));
        hn::Store(row.index, d, &block_row[n]);
        hn::Store(row.offset, d, &v[n]);
        const VD any = gather(t.row_sums, hn::Add(first_row, whole(t.block_rows - 1)));
        hn::Store(any, d, &b.density[n]);
    }
    for (std::size_t n = 0; n < kBatch; n += hn::Lanes(d)) {
        const VD row = hn::Add(hn::Mul(binOf(t, b, n), whole(t.block_rows)), hn::Load(d, &block_row[n]));
        const Found column =
            find(t.block_sums, hn::Mul(row, whole(t.block_columns)), t.block_columns, hn::Load(d, &b.u[n]));
        hn::Store(column.index, d, &block_column[n]);
        hn::Store(column.offset, d, &u[n]);
    }
    const std::size_t side = std::size_t{1} << t.shift;
    const auto blockAt = [&](std::size_t n) {
        return hn::Add(hn::Mul(hn::Load(d, &block_row[n]), whole(t.block_columns)), hn::Load(d, &block_column[n]));
    };
    alignas(64) Batch<double> inner_row;
    for (std::size_t n = 0; n < kBatch; n += hn::Lanes(d)) {
        const Found row = find(t.rows_in_block, hn::Mul(blockAt(n), whole(side)), side, hn::Load(d, &v[n]));
        hn::Store(row.index, d, &inner_row[n]);
        hn::Store(row.offset, d, &v[n]);
    }
    alignas(64) Batch<double> inner_column;
    for (std::size_t n = 0; n < kBatch; n += hn::Lanes(d)) {
        const VD row = hn::Add(hn::Mul(blockAt(n), whole(side)), hn::Load(d, &inner_row[n]));
        const Found column = find(t.cells_in_block, hn::Mul(row, whole(side)), side, hn::Load(d, &u[n]));
        hn::Store(column.index, d, &inner_column[n]);
        hn::Store(column.offset, d, &u[n]);
    }
    for (std::size_t n = 0; n < kBatch; n += hn::Lanes(d)) {
        const VD row0 = hn::Load(d, &block_row[n]);
        const VD column0 = hn::Load(d, &block_column[n]);
        // No draw falls on the cells that fill the outermost blocks up, unless there is nothing to draw at all.
        const VD row = hn::Min(hn::Add(hn::Mul(row0, whole(side)), hn::Load(d, &inner_row[n])), set(t.rows));
        const VD column =
            hn::Min(hn::Add(hn::Mul(column0, whole(side)), hn::Load(d, &inner_column[n])), set(t.columns - 1));
        const Corners c = corners(t, column, row);
        const VD y = drawLinear(hn::Add(c.w00, c.w10), hn::Add(c.w01, c.w11), hn::Load(d, &v[n]));
        const VD x = drawLinear(mix(y, c.w00, c.w01), mix(y, c.w10, c.w11), hn::Load(d, &u[n]));
        const VD px = hn::Div(hn::Add(hn::Add(column, x), set(0.5)), set(t.columns));
        const VD py = hn::Div(hn::Sub(hn::Add(row, y), set(0.5)), set(t.rows));
        const M inside =
            hn::And(hn::And(hn::Gt(py, set(0.0)), hn::Lt(py, set(1.0))), hn::Gt(hn::Load(d, &b.density[n]), set(0.0)));
        const VD density = hn::Mul(c.at(x, y), scale(t, binOf(t, b, n), row0, column0, row));
        hn::Store(hn::IfThenElseZero(inside, density), d, &b.density[n]);
        hn::Store(hn::IfThenElse(hn::Lt(px, set(1.0)), px, hn::Sub(px, set(1.0))), d, &b.x[n]);
        hn::Store(hn::Min(hn::Max(py, set(0.0)), set(1.0)), d, &b.y[n]);
    }
}

// Adds BilinearDistribution::pdf.
void AddDensity(const BilinearDistribution::View& t, MapBatch& b) {
    const D d;
    const VD zero = set(0.0);
    const VD per_side = set(1.0 / static_cast<double>(std::size_t{1} << t.shift));
    for (std::size_t n = 0; n < kBatch; n += hn::Lanes(d)) {
        VD sx = hn::Sub(hn::Mul(hn::Load(d, &b.x[n]), set(t.columns)), set(0.5));
        sx = hn::IfThenElse(hn::Lt(sx, zero), hn::Add(sx, set(t.columns)), sx);
        const VD sy = hn::Add(hn::Mul(hn::Load(d, &b.y[n]), set(t.rows)), set(0.5));
        const VD column = hn::Min(hn::Floor(sx), set(t.columns - 1));
        const VD row = hn::Min(hn::Floor(sy), set(t.rows));
        const VD density =
            scale(t, binOf(t, b, n), hn::Floor(hn::Mul(row, per_side)), hn::Floor(hn::Mul(column, per_side)), row);
        if (hn::AllFalse(d, hn::Gt(density, zero))) continue;
        const VD x = hn::Min(hn::Sub(sx, column), set(1.0));
        const VD y = hn::Min(hn::Sub(sy, row), set(1.0));
        const VD sum = hn::Add(hn::Load(d, &b.density[n]), hn::Mul(corners(t, column, row).at(x, y), density));
        hn::Store(sum, d, &b.density[n]);
    }
}

// Sine and cosine of an angle in turns, |t| < 2^20. Taylor's series up to an eighth of a turn: to 2e-9.
HWY_INLINE void sineAndCosine(VD t, VD& sine, VD& cosine) {
    const VD quarters = hn::Round(hn::Mul(t, set(4.0)));
    const VD a = hn::Mul(hn::Sub(t, hn::Mul(quarters, set(0.25))), set(kTurn));
    const VD a2 = hn::Mul(a, a);
    VD s = set(1.0 / 362880.0);
    for (const double c : {-1.0 / 5040.0, 1.0 / 120.0, -1.0 / 6.0, 1.0}) s = hn::Add(hn::Mul(s, a2), set(c));
    s = hn::Mul(s, a);
    VD c = set(-1.0 / 3628800.0);
    for (const double k : {1.0 / 40320.0, -1.0 / 720.0, 1.0 / 24.0, -0.5, 1.0}) c = hn::Add(hn::Mul(c, a2), set(k));
    const VD turn = hn::Sub(quarters, hn::Mul(set(4.0), hn::Floor(hn::Mul(quarters, set(0.25)))));  // 0, 1, 2 or 3
    const M swap = hn::Or(hn::Eq(turn, set(1.0)), hn::Eq(turn, set(3.0)));
    const VD sines = hn::IfThenElse(swap, c, s);
    const VD cosines = hn::IfThenElse(swap, s, c);
    sine = hn::IfThenElse(hn::Ge(turn, set(2.0)), hn::Neg(sines), sines);
    const M left = hn::Or(hn::Eq(turn, set(1.0)), hn::Eq(turn, set(2.0)));
    cosine = hn::IfThenElse(left, hn::Neg(cosines), cosines);
}

// atan2 in turns, to 4e-9. The series: M. Abramowitz, I. Stegun, "Handbook of Mathematical Functions", 4.4.49.
HWY_INLINE VD arcTurns(VD y, VD x) {
    const VD ax = hn::Abs(x);
    const VD ay = hn::Abs(y);
    const VD high = hn::Max(ax, ay);
    const VD r = hn::IfThenElseZero(hn::Gt(high, set(0.0)), hn::Div(hn::Min(ax, ay), high));
    const VD r2 = hn::Mul(r, r);
    VD a = set(0.0028662257);
    for (const double c :
         {-0.0161657367, 0.0429096138, -0.0752896400, 0.1065626393, -0.1420889944, 0.1999355085, -0.3333314528, 1.0})
        a = hn::Add(hn::Mul(a, r2), set(c));
    a = hn::Mul(hn::Mul(a, r), set(1.0 / kTurn));
    a = hn::IfThenElse(hn::Gt(ay, ax), hn::Sub(set(0.25), a), a);
    a = hn::IfThenElse(hn::Lt(x, set(0.0)), hn::Sub(set(0.5), a), a);
    return hn::CopySign(a, y);
}

// MapEnvironment's directionOf of the places, in single precision.
void Directions(double rotation, MapBatch& b) {
    const D d;
    const F f;
    const VD turned = set(0.5 + rotation / kTurn);
    for (std::size_t n = 0; n < kBatch; n += hn::Lanes(d)) {
        VD sine;
        VD cosine;
        sineAndCosine(hn::Mul(hn::Load(d, &b.y[n]), set(0.5)), sine, cosine);
        VD across;
        VD along;
        sineAndCosine(hn::Sub(turned, hn::Load(d, &b.x[n])), across, along);
        hn::Store(sine, d, &b.sine[n]);
        hn::Store(hn::PromoteTo(d, hn::DemoteTo(f, hn::Mul(sine, along))), d, &b.dx[n]);
        hn::Store(hn::PromoteTo(d, hn::DemoteTo(f, hn::Mul(sine, across))), d, &b.dy[n]);
        hn::Store(hn::PromoteTo(d, hn::DemoteTo(f, cosine)), d, &b.dz[n]);
    }
}

// MapEnvironment::place of the directions.
void Positions(double rotation, MapBatch& b) {
    const D d;
    const VD turned = set(0.5 + rotation / kTurn);
    for (std::size_t n = 0; n < kBatch; n += hn::Lanes(d)) {
        const VD dx = hn::Load(d, &b.dx[n]);
        const VD dy = hn::Load(d, &b.dy[n]);
        const VD sine = hn::Sqrt(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)));
        VD x = hn::Sub(turned, arcTurns(dy, dx));
        x = hn::Sub(x, hn::Floor(x));
        const VD y = hn::Mul(arcTurns(sine, hn::Load(d, &b.dz[n])), set(2.0));
        hn::Store(sine, d, &b.sine[n]);
        hn::Store(hn::IfThenElseZero(hn::Lt(x, set(1.0)), x), d, &b.x[n]);
        hn::Store(hn::Min(hn::Max(y, set(0.0)), set(1.0)), d, &b.y[n]);
    }
}

// MapEnvironment::lookUp of the places.
void LookUp(const LightMap& map, MapBatch& b) {
    static_assert(sizeof(Color) == 3 * sizeof(float));
    const D d;
    const F f;
    const VD zero = set(0.0);
    const float* texels = &map.texels[0].x;
    for (std::size_t n = 0; n < kBatch; n += hn::Lanes(d)) {
        VD sx = hn::Sub(hn::Mul(hn::Load(d, &b.x[n]), set(map.width)), set(0.5));
        sx = hn::IfThenElse(hn::Lt(sx, zero), hn::Add(sx, set(map.width)), sx);
        const VD sy = hn::Min(hn::Max(hn::Sub(hn::Mul(hn::Load(d, &b.y[n]), set(map.height)), set(0.5)), zero),
                              set(map.height - 1.0));
        const VD x0 = hn::Min(hn::Floor(sx), set(map.width - 1));
        const VD y0 = hn::Floor(sy);
        const VD next = hn::Add(x0, set(1.0));
        const VD x1 = hn::IfThenZeroElse(hn::Eq(next, set(map.width)), next);
        const VD y1 = hn::Min(hn::Add(y0, set(1.0)), set(map.height - 1));
        const VF wx = hn::DemoteTo(f, hn::Sub(sx, x0));
        const VF wy = hn::DemoteTo(f, hn::Sub(sy, y0));
        const auto texel = [&](VD x, VD y) {
            return hn::DemoteTo(I(), hn::Mul(hn::Add(hn::Mul(y, set(map.width)), x), set(3.0)));
        };
        const auto t00 = texel(x0, y0);
        const auto t10 = texel(x1, y0);
        const auto t01 = texel(x0, y1);
        const auto t11 = texel(x1, y1);
        const VF one = hn::Set(f, 1.0f);
        const auto row = [&](const float* channel, const auto& left, const auto& right) {
            return hn::Add(hn::Mul(hn::Sub(one, wx), hn::GatherIndex(f, channel, left)),
                           hn::Mul(wx, hn::GatherIndex(f, channel, right)));
        };
        const auto value = [&](const float* channel) {
            return hn::Add(hn::Mul(hn::Sub(one, wy), row(channel, t00, t10)), hn::Mul(wy, row(channel, t01, t11)));
        };
        hn::Store(value(texels), f, &b.r[n]);
        hn::Store(value(texels + 1), f, &b.g[n]);
        hn::Store(value(texels + 2), f, &b.b[n]);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace
}  // namespace stratum::shade
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stratum::shade {
namespace {
HWY_EXPORT(Draw);
HWY_EXPORT(AddDensity);
HWY_EXPORT(Directions);
HWY_EXPORT(Positions);
HWY_EXPORT(LookUp);

void setBins(std::span<const glm::vec3> normals, std::size_t first, std::size_t count, MapBatch& b) {
    if (normals.empty()) return;
    for (std::size_t n = 0; n < count; ++n) b.bin[n] = NormalBins::of(normals[first + n]);
}

void setDirections(std::span<const glm::vec3> directions, std::size_t first, std::size_t count, MapBatch& b) {
    for (std::size_t n = 0; n < count; ++n) {
        b.dx[n] = static_cast<double>(directions[first + n].x);
        b.dy[n] = static_cast<double>(directions[first + n].y);
        b.dz[n] = static_cast<double>(directions[first + n].z);
    }
}

void get(const MapBatch& b, std::size_t first, std::size_t count, std::span<EnvironmentSample> samples) {
    for (std::size_t n = 0; n < count; ++n) {
        EnvironmentSample& sample = samples[first + n];
        sample.radiance = {b.r[n], b.g[n], b.b[n]};
        const auto pdf = static_cast<float>(b.density[n] / (0.5 * kTurn * kTurn * b.sine[n]));
        sample.pdf = b.sine[n] > 0.0 && std::isfinite(pdf) ? pdf : 0.0f;
    }
}

}  // namespace

void sampleMap(const PlacedMap& placed, int strategy, std::span<const glm::vec2> u, std::span<const glm::vec3> normals,
               std::span<EnvironmentSample> samples) {
    MapBatch batch{};
    const auto chosen = static_cast<std::size_t>(strategy);
    for (std::size_t first = 0; first < u.size(); first += kBatch) {
        const std::size_t count = std::min(kBatch, u.size() - first);
        setBins(normals, first, count, batch);
        for (std::size_t n = 0; n < count; ++n) {
            batch.u[n] = static_cast<double>(u[first + n].x);
            batch.v[n] = static_cast<double>(u[first + n].y);
        }
        HWY_DYNAMIC_DISPATCH(Draw)(placed.tables[chosen].view(), batch);
        // A draw without a sample stays without one.
        Batch<bool> none;
        for (std::size_t n = 0; n < count; ++n) none[n] = !(batch.density[n] > 0.0);
        for (std::size_t k = 0; k < placed.tables.size(); ++k)
            if (k != chosen) HWY_DYNAMIC_DISPATCH(AddDensity)(placed.tables[k].view(), batch);
        HWY_DYNAMIC_DISPATCH(Directions)(placed.rotation, batch);
        HWY_DYNAMIC_DISPATCH(LookUp)(placed.map, batch);
        get(batch, first, count, samples);
        for (std::size_t n = 0; n < count; ++n) {
            samples[first + n].direction = glm::vec3(batch.dx[n], batch.dy[n], batch.dz[n]);
            if (none[n]) samples[first + n].pdf = 0.0f;
        }
    }
}

void evalMap(const PlacedMap& placed, std::span<const glm::vec3> directions, std::span<const glm::vec3> normals,
             std::span<EnvironmentSample> samples) {
    MapBatch batch{};
    for (std::size_t first = 0; first < directions.size(); first += kBatch) {
        const std::size_t count = std::min(kBatch, directions.size() - first);
        setBins(normals, first, count, batch);
        setDirections(directions, first, count, batch);
        batch.density.fill(0.0);
        HWY_DYNAMIC_DISPATCH(Positions)(placed.rotation, batch);
        for (const BilinearDistribution& table : placed.tables) HWY_DYNAMIC_DISPATCH(AddDensity)(table.view(), batch);
        HWY_DYNAMIC_DISPATCH(LookUp)(placed.map, batch);
        get(batch, first, count, samples);
        for (std::size_t n = 0; n < count; ++n) samples[first + n].direction = directions[first + n];
    }
}

void mapRadiance(const PlacedMap& placed, std::span<const glm::vec3> directions, std::span<Color> radiances) {
    MapBatch batch{};
    for (std::size_t first = 0; first < directions.size(); first += kBatch) {
        const std::size_t count = std::min(kBatch, directions.size() - first);
        setDirections(directions, first, count, batch);
        HWY_DYNAMIC_DISPATCH(Positions)(placed.rotation, batch);
        HWY_DYNAMIC_DISPATCH(LookUp)(placed.map, batch);
        for (std::size_t n = 0; n < count; ++n) radiances[first + n] = {batch.r[n], batch.g[n], batch.b[n]};
    }
}

}  // namespace stratum::shade
#endif  // HWY_ONCE
