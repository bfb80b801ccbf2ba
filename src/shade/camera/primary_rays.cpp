#include "shade/camera/ray_streams.h"

#include <algorithm>
#include <array>
#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shade/camera/primary_rays.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "shade/camera/sobol_lanes-inl.h"

#ifndef STRATUM_PRIMARY_RAYS_TYPES
#define STRATUM_PRIMARY_RAYS_TYPES
namespace stratum::shade {
namespace {

// Samples at a time: whole vectors on every target, and all of it stays in the first-level cache.
constexpr std::size_t kBatch = 64;
template <typename T>
using Batch = std::array<T, kBatch>;

struct alignas(64) FirstDraws {
    Batch<std::uint32_t> block, index;  // of Sampler, before the first draw
};
struct alignas(64) Positions {
    Batch<double> x, y;  // pixels; as input the pixels' centers
};
struct alignas(64) Directions {
    Batch<double> x, y, z;
};

}  // namespace
}  // namespace stratum::shade
#endif

HWY_BEFORE_NAMESPACE();
namespace stratum::shade {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<double, 8>;
using VD = hn::Vec<D>;

// PixelFilter::offset of u, whose first 32 bits are `bits`. A float holds 24 of them: 10 are the index of the table's
// interval and 14 the position in it, so that everything before the interpolation is exact.
HWY_INLINE VD quantile(const double* HWY_RESTRICT table, const std::uint32_t* HWY_RESTRICT bits) {
    static_assert(PixelFilter::kNodes == 1025);
    const D d;
    const hn::Rebind<std::int32_t, D> i32;
    const hn::RebindToSigned<D> i64;
    const auto v = hn::LoadU(hn::Rebind<std::uint32_t, D>(), bits);
    const auto node = hn::PromoteTo(i64, hn::BitCast(i32, hn::ShiftRight<22>(v)));
    const auto rest = hn::And(hn::ShiftRight<8>(v), hn::Set(hn::Rebind<std::uint32_t, D>(), 0x3fffu));
    const VD w = hn::Mul(hn::PromoteTo(d, hn::BitCast(i32, rest)), hn::Set(d, 0x1p-14));
    const VD here = hn::GatherIndex(d, table, node);
    const VD next = hn::GatherIndex(d, table + 1, node);
    return hn::Add(hn::Mul(hn::Sub(hn::Set(d, 1.0), w), here), hn::Mul(w, next));
}

void AddOffsets(const FirstDraws& draws, const double* HWY_RESTRICT table, Positions& positions) {
    const U u;
    const D d;
    alignas(64) Batch<std::uint32_t> x, y;
    for (std::size_t n = 0; n < kBatch; n += hn::Lanes(u)) {
        const Draw2D drawn = draw2D(hn::Load(u, &draws.block[n]), hn::Load(u, &draws.index[n]), set(0u));
        hn::Store(drawn.x, u, &x[n]);
        hn::Store(drawn.y, u, &y[n]);
    }
    for (std::size_t n = 0; n < kBatch; n += hn::Lanes(d)) {
        hn::Store(hn::Add(hn::Load(d, &positions.x[n]), quantile(table, &x[n])), d, &positions.x[n]);
        hn::Store(hn::Add(hn::Load(d, &positions.y[n]), quantile(table, &y[n])), d, &positions.y[n]);
    }
}

void Pinhole(const Camera& camera, const Positions& positions, Directions& out) {
    const D d;
    const VD scale = hn::Set(d, camera.pixelSize());
    const VD half_width = hn::Set(d, 0.5 * camera.width());
    const VD half_height = hn::Set(d, 0.5 * camera.height());
    for (std::size_t n = 0; n < kBatch; n += hn::Lanes(d)) {
        const VD x = hn::Mul(hn::Sub(hn::Load(d, &positions.x[n]), half_width), scale);
        const VD y = hn::Mul(hn::Sub(half_height, hn::Load(d, &positions.y[n])), scale);
        const auto axis = [&](int k) {
            const VD forward_right =
                hn::Add(hn::Set(d, camera.forward()[k]), hn::Mul(x, hn::Set(d, camera.right()[k])));
            return hn::Add(forward_right, hn::Mul(y, hn::Set(d, camera.up()[k])));
        };
        const VD dx = axis(0);
        const VD dy = axis(1);
        const VD dz = axis(2);
        const VD square = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
        const VD shrink = hn::Div(hn::Set(d, 1.0), hn::Sqrt(square));
        hn::Store(hn::Mul(dx, shrink), d, &out.x[n]);
        hn::Store(hn::Mul(dy, shrink), d, &out.y[n]);
        hn::Store(hn::Mul(dz, shrink), d, &out.z[n]);
    }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace stratum::shade
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stratum::shade {
namespace {
HWY_EXPORT(AddOffsets);
HWY_EXPORT(Pinhole);
}  // namespace

void primaryRays(const Camera& camera, const PixelFilter& filter, std::span<const glm::ivec2> pixels,
                 std::span<Sampler> samplers, std::span<trace::Ray> rays) {
    FirstDraws draws{};
    Positions positions{};
    Directions directions;
    for (std::size_t first = 0; first < rays.size(); first += kBatch) {
        const std::size_t count = std::min(kBatch, rays.size() - first);
        for (std::size_t n = 0; n < count; ++n) {
            const Sampler& sampler = samplers[first + n];
            draws.block[n] = sampler.block();
            draws.index[n] = sampler.index();
            positions.x[n] = pixels[first + n].x + 0.5;
            positions.y[n] = pixels[first + n].y + 0.5;
        }
        HWY_DYNAMIC_DISPATCH(AddOffsets)(draws, filter.quantiles().data(), positions);
        for (std::size_t n = 0; n < count; ++n) samplers[first + n].skip();
        if (camera.hasLens()) {
            for (std::size_t n = 0; n < count; ++n)
                rays[first + n] = camera.ray({positions.x[n], positions.y[n]}, samplers[first + n].next2D());
            continue;
        }
        HWY_DYNAMIC_DISPATCH(Pinhole)(camera, positions, directions);
        for (std::size_t n = 0; n < count; ++n) {
            trace::Ray& ray = rays[first + n];
            ray = trace::Ray();
            ray.origin = camera.eye();
            ray.direction = {directions.x[n], directions.y[n], directions.z[n]};
        }
    }
}

trace::Ray anyPrimaryRay(const Camera& camera, Sampler& sampler) {
    const glm::dvec2 pixel = glm::dvec2(sampler.next2D()) * glm::dvec2(camera.width(), camera.height());
    return camera.hasLens() ? camera.ray(pixel, sampler.next2D()) : camera.ray(pixel);
}

}  // namespace stratum::shade
#endif  // HWY_ONCE
