#include "shade/environment/map_stream.h"

#include "shade/environment/normal_bins.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shade/environment/map_stream.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "shade/angle_lanes-inl.h"

#ifndef STRATUM_MAP_STREAM_TYPES
#define STRATUM_MAP_STREAM_TYPES
namespace stratum::shade {
namespace {

// Surfaces at a time: whole vectors on every target, enough cache misses to be served together, and small enough for
// the first-level cache.
constexpr std::size_t kBatch = 64;
constexpr std::size_t kLanes = 8;  // doubles in the widest vector
constexpr std::size_t wholeVectors(std::size_t count) { return (count + kLanes - 1) / kLanes * kLanes; }
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
    Batch<Color> radiance;
    std::size_t count = 0;  // of surfaces, in whole vectors: the last ones may mean nothing
};

}  // namespace
}  // namespace stratum::shade
#endif

HWY_BEFORE_NAMESPACE();
namespace stratum::shade {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
// Doubles: the position in a cell of a large map is in the digits of a draw below those
// that select the cell. Whole numbers in them are indices.
using D = hn::CappedTag<double, kLanes>;
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

// The largest number of the sums' type that is not above the target: as many sums are at most that.
HWY_INLINE float limitOf(double target, const float*) {
    const auto nearest = static_cast<float>(target);
    // Above a target of 0 or more it is positive: the next number below has the next lower bits.
    // No branch: one draw in two would be mispredicted.
    const auto above = static_cast<std::uint32_t>(static_cast<double>(nearest) > target);
    return std::bit_cast<float>(std::bit_cast<std::uint32_t>(nearest) - above);
}
HWY_INLINE double limitOf(double target, const double*) { return target; }

// The interval of a running sum in which u times its end falls, never an empty one, and the offset in it. Neighbours
// are compared all at once: steps of a binary search would wait for each other.
template <typename T>
HWY_INLINE double find(const T* HWY_RESTRICT sums, std::size_t count, double u, std::int32_t& interval) {
    constexpr std::size_t kAtOnce = 32;
    const hn::CappedTag<T, 16> d;
    const double target = u * static_cast<double>(sums[count - 1]);
    const T limit = limitOf(target, sums);
    std::size_t index = 0;
    std::size_t left = count;
    while (left > kAtOnce) {
        const std::size_t half = left / 2;
        index += sums[index + half - 1] <= limit ? half : 0;
        left -= half;
    }
    const std::size_t first = index;
    for (std::size_t n = 0; n + 1 < left; n += hn::Lanes(d)) {
        const auto below = hn::Le(hn::LoadU(d, sums + first + n), hn::Set(d, limit));
        index += hn::CountTrue(d, hn::And(below, hn::FirstN(d, left - 1 - n)));
    }
    const double start = index > 0 ? static_cast<double>(sums[index - 1]) : 0.0;
    const double width = static_cast<double>(sums[index]) - start;
    const double offset = std::min(std::max((target - start) / width, 0.0), kBelowOne);
    // An empty interval has width 0, and the offset in it must not become an index.
    interval = static_cast<std::int32_t>(index);
    return width > 0.0 ? offset : 0.0;
}

HWY_INLINE VD mix(VD w, VD a, VD b) { return hn::Add(hn::Mul(hn::Sub(set(1.0), w), a), hn::Mul(w, b)); }

// The quantile u of a density that is linear from a to b over [0, 1): the root without cancellation, for falling and
// rising densities alike.
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

// Density over interpolated weight, in a cell.
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

// Draws positions on the map, and their density. Each search is done for the whole batch before the next one, so that
// the loads of many draws are served together.
void Draw(const BilinearDistribution::View& t, MapBatch& b) {
    const D d;
    const I i;
    alignas(64) Batch<std::int32_t> block_row, block_column, inner_row, inner_column;
    alignas(64) Batch<double> u, v;
    const std::size_t side = std::size_t{1} << t.shift;
    const auto blockAt = [&](std::size_t n) {
        return static_cast<std::size_t>(block_row[n]) * t.block_columns + static_cast<std::size_t>(block_column[n]);
    };
    const auto cellsAt = [&](std::size_t n) {
        return t.cells_in_block + (blockAt(n) * side + static_cast<std::size_t>(inner_row[n])) * side;
    };
    for (std::size_t n = 0; n < b.count; ++n) {
        const double* sums = t.row_sums + (t.bins == 1 ? 0 : static_cast<std::size_t>(b.bin[n])) * t.block_rows;
        v[n] = find(sums, t.block_rows, b.v[n], block_row[n]);
        b.density[n] = sums[t.block_rows - 1];
    }
    for (std::size_t n = 0; n < b.count; ++n) {
        const std::size_t first_row = (t.bins == 1 ? 0 : static_cast<std::size_t>(b.bin[n])) * t.block_rows;
        const std::size_t row = first_row + static_cast<std::size_t>(block_row[n]);
        u[n] = find(t.block_sums + row * t.block_columns, t.block_columns, b.u[n], block_column[n]);
    }
    for (std::size_t n = 0; n < b.count; ++n)
        v[n] = find(t.rows_in_block + blockAt(n) * side, side, v[n], inner_row[n]);
    for (std::size_t n = 0; n < b.count; ++n) u[n] = find(cellsAt(n), side, u[n], inner_column[n]);
    const auto load = [&](const Batch<std::int32_t>& from, std::size_t n)
                          HWY_ATTR { return hn::PromoteTo(d, hn::Load(i, &from[n])); };
    for (std::size_t n = 0; n < b.count; n += hn::Lanes(d)) {
        const VD row0 = load(block_row, n);
        const VD column0 = load(block_column, n);
        // No draw falls on the cells that fill the outermost blocks up, unless there is nothing to draw at all.
        const VD row = hn::Min(hn::Add(hn::Mul(row0, whole(side)), load(inner_row, n)), set(t.rows));
        const VD column = hn::Min(hn::Add(hn::Mul(column0, whole(side)), load(inner_column, n)), set(t.columns - 1));
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

// Adds the density at the positions.
void AddDensity(const BilinearDistribution::View& t, MapBatch& b) {
    const D d;
    const VD zero = set(0.0);
    const VD per_side = set(1.0 / static_cast<double>(std::size_t{1} << t.shift));
    for (std::size_t n = 0; n < b.count; n += hn::Lanes(d)) {
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

// The directions of the positions, in single precision.
void Directions(double rotation, MapBatch& b) {
    const D d;
    const F f;
    const VD turned = set(0.5 + rotation / kTurn);
    for (std::size_t n = 0; n < b.count; n += hn::Lanes(d)) {
        VD sine;
        VD cosine;
        sineAndCosine(d, hn::Mul(hn::Load(d, &b.y[n]), set(0.5)), sine, cosine);
        VD across;
        VD along;
        sineAndCosine(d, hn::Sub(turned, hn::Load(d, &b.x[n])), across, along);
        hn::Store(sine, d, &b.sine[n]);
        hn::Store(hn::PromoteTo(d, hn::DemoteTo(f, hn::Mul(sine, along))), d, &b.dx[n]);
        hn::Store(hn::PromoteTo(d, hn::DemoteTo(f, hn::Mul(sine, across))), d, &b.dy[n]);
        hn::Store(hn::PromoteTo(d, hn::DemoteTo(f, cosine)), d, &b.dz[n]);
    }
}

// The positions of the directions.
void Positions(double rotation, MapBatch& b) {
    const D d;
    const VD turned = set(0.5 + rotation / kTurn);
    for (std::size_t n = 0; n < b.count; n += hn::Lanes(d)) {
        const VD dx = hn::Load(d, &b.dx[n]);
        const VD dy = hn::Load(d, &b.dy[n]);
        const VD sine = hn::Sqrt(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)));
        VD x = hn::Sub(turned, arcTurns(d, dy, dx));
        x = hn::Sub(x, hn::Floor(x));
        const VD y = hn::Mul(arcTurns(d, sine, hn::Load(d, &b.dz[n])), set(2.0));
        hn::Store(sine, d, &b.sine[n]);
        hn::Store(hn::IfThenElseZero(hn::Lt(x, set(1.0)), x), d, &b.x[n]);
        hn::Store(hn::Min(hn::Max(y, set(0.0)), set(1.0)), d, &b.y[n]);
    }
}

// The radiance at the positions, interpolated bilinearly. Texels are read one by one: three floats side by side are one
// load, where gathers would be three.
void LookUp(const LightMap& map, MapBatch& b) {
    const D d;
    const F f;
    const I i;
    const VD zero = set(0.0);
    alignas(64) Batch<std::int32_t> left, right, above, below;  // columns, and the first texels of rows
    alignas(64) Batch<float> wx, wy;
    for (std::size_t n = 0; n < b.count; n += hn::Lanes(d)) {
        VD sx = hn::Sub(hn::Mul(hn::Load(d, &b.x[n]), set(map.width)), set(0.5));
        sx = hn::IfThenElse(hn::Lt(sx, zero), hn::Add(sx, set(map.width)), sx);
        const VD sy = hn::Min(hn::Max(hn::Sub(hn::Mul(hn::Load(d, &b.y[n]), set(map.height)), set(0.5)), zero),
                              set(map.height - 1.0));
        const VD x0 = hn::Min(hn::Floor(sx), set(map.width - 1));
        const VD y0 = hn::Floor(sy);
        const VD next = hn::Add(x0, set(1.0));
        const VD y1 = hn::Min(hn::Add(y0, set(1.0)), set(map.height - 1));
        hn::Store(hn::DemoteTo(i, x0), i, &left[n]);
        hn::Store(hn::DemoteTo(i, hn::IfThenZeroElse(hn::Eq(next, set(map.width)), next)), i, &right[n]);
        hn::Store(hn::DemoteTo(i, hn::Mul(y0, set(map.width))), i, &above[n]);
        hn::Store(hn::DemoteTo(i, hn::Mul(y1, set(map.width))), i, &below[n]);
        hn::Store(hn::DemoteTo(f, hn::Sub(sx, x0)), f, &wx[n]);
        hn::Store(hn::DemoteTo(f, hn::Sub(sy, y0)), f, &wy[n]);
    }
    const Color* const texels = map.texels.data();
    for (std::size_t n = 0; n < b.count; ++n) {
        const auto row = [&](const Color* texel) { return (1.0f - wx[n]) * texel[left[n]] + wx[n] * texel[right[n]]; };
        b.radiance[n] = (1.0f - wy[n]) * row(texels + above[n]) + wy[n] * row(texels + below[n]);
    }
}

}  // namespace
}  // namespace HWY_NAMESPACE
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
        sample.radiance = b.radiance[n];
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
        batch.count = wholeVectors(count);
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
        batch.count = wholeVectors(count);
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
        batch.count = wholeVectors(count);
        setDirections(directions, first, count, batch);
        HWY_DYNAMIC_DISPATCH(Positions)(placed.rotation, batch);
        HWY_DYNAMIC_DISPATCH(LookUp)(placed.map, batch);
        for (std::size_t n = 0; n < count; ++n) radiances[first + n] = batch.radiance[n];
    }
}

}  // namespace stratum::shade
#endif  // HWY_ONCE
