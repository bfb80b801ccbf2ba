#include "shade/camera/ray_streams.h"

#include "shade/camera/sampling.h"
#include "shade/frame.h"

#include <algorithm>
#include <array>
#include <cstddef>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shade/camera/hemisphere_stream.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef STRATUM_HEMISPHERE_STREAM_TYPES
#define STRATUM_HEMISPHERE_STREAM_TYPES
namespace stratum::shade {
namespace {

constexpr std::size_t kBatch = 64;  // whole vectors on every target

struct alignas(64) HemisphereBatch {
    std::array<float, kBatch> u, v;        // draws
    std::array<float, kBatch> nx, ny, nz;  // normals
    std::array<double, kBatch> x, y, z;    // directions
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
using D = hn::CappedTag<double, 8>;
using VF = hn::Vec<F>;
using VD = hn::Vec<D>;

struct Float3 {
    VF x, y, z;
};

HWY_INLINE VF constant(float value) { return hn::Set(F(), value); }

// toCosineHemisphere, operation by operation; zero where its z is not positive.
HWY_INLINE Float3 aroundZ(VF u, VF v) {
    const VF one = constant(1.0f);
    const VF a = hn::Sub(hn::Mul(constant(2.0f), u), one);
    const VF b = hn::Sub(hn::Mul(constant(2.0f), v), one);
    const auto wide = hn::Gt(hn::Abs(a), hn::Abs(b));
    const VF r = hn::IfThenElse(wide, a, b);
    // The middle of the square is 0 / 0; with r = 0 any quotient stands for the middle of the disc.
    const VF quotient = hn::IfThenElseZero(hn::Ne(r, hn::Zero(F())), hn::Div(hn::IfThenElse(wide, b, a), r));
    const VF phi = hn::Mul(constant(0.25f * kPi), quotient);
    const VF p2 = hn::Mul(phi, phi);
    const auto series = [&](float k1, float k2, float k3, float k4) {
        VF sum = hn::Sub(constant(k3), hn::Mul(p2, constant(k4)));
        sum = hn::Sub(constant(k2), hn::Mul(p2, sum));
        sum = hn::Sub(constant(k1), hn::Mul(p2, sum));
        return hn::Sub(one, hn::Mul(p2, sum));
    };
    const VF along = hn::Mul(r, series(1.0f / 2, 1.0f / 24, 1.0f / 720, 1.0f / 40320));
    const VF across = hn::Mul(r, hn::Mul(phi, series(1.0f / 6, 1.0f / 120, 1.0f / 5040, 1.0f / 362880)));
    const VF x = hn::IfThenElse(wide, along, across);
    const VF y = hn::IfThenElse(wide, across, along);
    const VF rest = hn::Sub(hn::Sub(one, hn::Mul(x, x)), hn::Mul(y, y));
    const auto above = hn::Gt(rest, hn::Zero(F()));
    const VF z = hn::Sqrt(hn::IfThenElseZero(above, rest));
    return {hn::IfThenElseZero(above, x), hn::IfThenElseZero(above, y), z};
}

// Frame(n).toWorld(v)
HWY_INLINE Float3 toWorld(const Float3& n, const Float3& v) {
    const VF one = constant(1.0f);
    const VF sign = hn::IfThenElse(hn::Lt(n.z, constant(shade::Frame::kFlipZ)), constant(-1.0f), one);
    const VF a = hn::Div(constant(-1.0f), hn::Add(sign, n.z));
    const VF b = hn::Mul(hn::Mul(n.x, n.y), a);
    const VF xx = hn::Add(one, hn::Mul(hn::Mul(hn::Mul(sign, n.x), n.x), a));
    const VF xy = hn::Mul(sign, b);
    const VF xz = hn::Mul(hn::Neg(sign), n.x);
    const VF yy = hn::Add(sign, hn::Mul(hn::Mul(n.y, n.y), a));
    const auto sum = [&](VF x, VF y, VF z) {
        return hn::Add(hn::Add(hn::Mul(v.x, x), hn::Mul(v.y, y)), hn::Mul(v.z, z));
    };
    return {sum(xx, b, n.x), sum(xy, yy, n.y), sum(xz, hn::Neg(n.y), n.z)};
}

void AroundNormals(HemisphereBatch& batch) {
    const F f;
    const D d;
    const hn::Rebind<float, D> half;
    alignas(64) std::array<float, kBatch> x, y, z;
    for (std::size_t n = 0; n < kBatch; n += hn::Lanes(f)) {
        const Float3 local = aroundZ(hn::Load(f, &batch.u[n]), hn::Load(f, &batch.v[n]));
        const Float3 normal{hn::Load(f, &batch.nx[n]), hn::Load(f, &batch.ny[n]), hn::Load(f, &batch.nz[n])};
        const Float3 world = toWorld(normal, local);
        hn::Store(world.x, f, &x[n]);
        hn::Store(world.y, f, &y[n]);
        hn::Store(world.z, f, &z[n]);
    }
    for (std::size_t n = 0; n < kBatch; n += hn::Lanes(d)) {
        const VD dx = hn::PromoteTo(d, hn::Load(half, &x[n]));
        const VD dy = hn::PromoteTo(d, hn::Load(half, &y[n]));
        const VD dz = hn::PromoteTo(d, hn::Load(half, &z[n]));
        const VD square = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
        // What is to be rejected stays zero.
        const auto some = hn::Gt(square, hn::Zero(d));
        const VD shrink = hn::IfThenElseZero(some, hn::Div(hn::Set(d, 1.0), hn::Sqrt(square)));
        hn::Store(hn::Mul(dx, shrink), d, &batch.x[n]);
        hn::Store(hn::Mul(dy, shrink), d, &batch.y[n]);
        hn::Store(hn::Mul(dz, shrink), d, &batch.z[n]);
    }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace stratum::shade
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stratum::shade {
namespace {
HWY_EXPORT(AroundNormals);
}  // namespace

void cosineDirections(std::span<const glm::vec3> normals, std::span<const glm::vec2> draws,
                      std::span<glm::dvec3> directions) {
    HemisphereBatch batch{};
    for (std::size_t first = 0; first < normals.size(); first += kBatch) {
        const std::size_t count = std::min(kBatch, normals.size() - first);
        for (std::size_t n = 0; n < count; ++n) {
            batch.u[n] = draws[first + n].x;
            batch.v[n] = draws[first + n].y;
            batch.nx[n] = normals[first + n].x;
            batch.ny[n] = normals[first + n].y;
            batch.nz[n] = normals[first + n].z;
        }
        HWY_DYNAMIC_DISPATCH(AroundNormals)(batch);
        for (std::size_t n = 0; n < count; ++n) directions[first + n] = {batch.x[n], batch.y[n], batch.z[n]};
    }
}

}  // namespace stratum::shade
#endif  // HWY_ONCE
