#include "shade/brdf/albedo_table.h"

#include "base/parallel_for.h"
#include "shade/brdf/gloss_mixture.h"

#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shade/brdf/albedo_table.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef STRATUM_ALBEDO_TABLE_TYPES
#define STRATUM_ALBEDO_TABLE_TYPES
namespace stratum::shade {
namespace {

constexpr std::size_t kMostAngles = 64;

/// A ring of facet normals that are visible from a direction: what Ggx::sampleVisible() computes for u.y, and the
/// cosines and sines of its angles for all u.x. The direction's own numbers are in it, too.
struct alignas(64) FacetRing {
    Ggx ggx;
    std::array<float, kMostAngles> cosines{}, sines{};
    glm::vec3 stretched{0.0f};  // the direction among facets that are a hemisphere
    glm::vec3 wo{0.0f};
    float radius = 0.0f, z = 0.0f;
    float wo_stretch = 0.0f;
    float eta = 0.0f;  // 0: all light is reflected
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
using V = hn::Vec<F>;

HWY_INLINE V set(float v) { return hn::Set(F(), v); }

// fresnelDielectric(), step by step.
HWY_INLINE V fresnel(V cosine, float eta) {
    const V one = set(1.0f);
    const V n = set(eta);
    const V c = hn::Min(cosine, one);
    const V t = hn::Sqrt(hn::Sub(one, hn::Div(hn::Sub(one, hn::Mul(c, c)), set(eta * eta))));
    const V parallel = hn::Div(hn::Sub(hn::Mul(n, c), t), hn::Add(hn::Mul(n, c), t));
    const V perpendicular = hn::Div(hn::Sub(c, hn::Mul(n, t)), hn::Add(c, hn::Mul(n, t)));
    return hn::Mul(set(0.5f), hn::Add(hn::Mul(parallel, parallel), hn::Mul(perpendicular, perpendicular)));
}

// What each facet of the ring reflects, weighted by shadowing; 0 where it reflects nothing upwards.
void Reflected(const FacetRing& ring, std::size_t angles, float* values) {
    const F f;
    const V zero = hn::Zero(f);
    for (std::size_t n = 0; n < angles; n += hn::Lanes(f)) {
        // Ggx::sampleVisible().
        const V x = hn::Add(hn::Mul(set(ring.radius), hn::Load(f, &ring.cosines[n])), set(ring.stretched.x));
        const V y = hn::Add(hn::Mul(set(ring.radius), hn::Load(f, &ring.sines[n])), set(ring.stretched.y));
        const V hx = hn::Mul(x, set(ring.ggx.along()));
        const V hy = hn::Mul(y, set(ring.ggx.across()));
        const V hz = hn::Max(set(ring.z + ring.stretched.z), zero);
        const V length2 = hn::Add(hn::Add(hn::Mul(hx, hx), hn::Mul(hy, hy)), hn::Mul(hz, hz));
        const V scale = hn::Div(set(1.0f), hn::Sqrt(length2));
        const V nx = hn::Mul(hx, scale);
        const V ny = hn::Mul(hy, scale);
        const V nz = hn::Mul(hz, scale);
        // The mirror direction.
        const V c =
            hn::Add(hn::Add(hn::Mul(set(ring.wo.x), nx), hn::Mul(set(ring.wo.y), ny)), hn::Mul(set(ring.wo.z), nz));
        const V twice = hn::Mul(set(2.0f), c);
        const V wx = hn::Sub(hn::Mul(twice, nx), set(ring.wo.x));
        const V wy = hn::Sub(hn::Mul(twice, ny), set(ring.wo.y));
        const V wz = hn::Sub(hn::Mul(twice, nz), set(ring.wo.z));
        // Ggx::shadowing().
        const V spread = hn::Add(hn::Mul(hn::Mul(set(ring.ggx.alongByAcross()), wx), wx),
                                 hn::Mul(hn::Mul(set(ring.ggx.acrossByAlong()), wy), wy));
        const V stretch = hn::Sqrt(hn::Add(hn::Mul(wz, wz), hn::Mul(set(ring.ggx.product()), spread)));
        V value = hn::Div(hn::Mul(wz, set(ring.wo.z + ring.wo_stretch)),
                          hn::Add(hn::Mul(set(ring.wo_stretch), wz), hn::Mul(stretch, set(ring.wo.z))));
        if (ring.eta > 0.0f) value = hn::Mul(fresnel(c, ring.eta), value);
        const auto upwards = hn::And(hn::Gt(c, zero), hn::Gt(wz, zero));
        hn::Store(hn::IfThenElseZero(upwards, value), f, values + n);
    }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace stratum::shade
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stratum::shade {
namespace {
HWY_EXPORT(Reflected);

/// E of a direction, by quadrature over visible normals, which flattens the integrand for every alpha.
/// @param eta            0: all light is reflected
/// @param azimuth_sine2  sin^2 of the direction's azimuth
double quadrature(const Ggx& ggx, float eta, float cosine, float azimuth_sine2) {
    const std::size_t rings = ggx.isotropic() ? 96 : 48;
    const std::size_t angles = ggx.isotropic() ? kMostAngles : kMostAngles / 2;
    // How facets are drawn: evenly, or closer where they are steep, which lose light from a sharp limit on; that
    // matters where all of the light is reflected.
    const bool even = eta > 0.0f;
    const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
    FacetRing ring{.ggx = ggx};
    ring.wo = {sine * std::sqrt(1.0f - azimuth_sine2), sine * std::sqrt(azimuth_sine2), cosine};
    ring.stretched = glm::normalize(glm::vec3(ring.wo.x * ggx.along(), ring.wo.y * ggx.across(), ring.wo.z));
    ring.wo_stretch = ggx.stretch(ring.wo);
    ring.eta = eta;
    // Half of the angles are sufficient where wo is in a plane of symmetry: then y is 0, or x.
    const float turn = azimuth_sine2 == 0.0f ? 0.5f : 1.0f;
    for (std::size_t j = 0; j < angles; ++j) {
        const float phi = 2.0f * kPi * (turn * (static_cast<float>(j) + 0.5f) / static_cast<float>(angles));
        ring.cosines[j] = std::cos(phi);
        ring.sines[j] = std::sin(phi);
    }
    alignas(64) std::array<float, kMostAngles> values;
    double sum = 0.0;
    for (std::size_t i = 0; i < rings; ++i) {
        const float v = (static_cast<float>(i) + 0.5f) / static_cast<float>(rings);
        const double weight = even ? 1.0 : static_cast<double>(3.0f * v * v);
        const float height = even ? v : 1.0f - v * v * v;
        ring.z = (1.0f - height) * (1.0f + ring.stretched.z) - ring.stretched.z;
        ring.radius = std::sqrt(std::clamp(1.0f - ring.z * ring.z, 0.0f, 1.0f));
        HWY_DYNAMIC_DISPATCH(Reflected)(ring, angles, values.data());
        for (std::size_t j = 0; j < angles; ++j) sum += weight * static_cast<double>(values[j]);
    }
    // The midpoint rule integrates 3 v^2 to 1 - 1 / (4 rings^2).
    const auto count = static_cast<double>(rings);
    const double whole = even ? 1.0 : 1.0 - 0.25 / (count * count);
    return std::min(sum / (count * static_cast<double>(angles)) / whole, 1.0);
}

}  // namespace

AlbedoTable::AlbedoTable(const Ggx& ggx, float eta) : rows_(ggx.isotropic() ? 1 : kAzimuths) {
    parallelFor(rows_.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t row = first; row != last; ++row) {
            const float sine2 = rows_.size() > 1 ? static_cast<float>(row) / (kAzimuths - 1) : 0.0f;
            for (int i = 0; i < kNodes; ++i) {
                const float s = static_cast<float>(i) / (kNodes - 1);
                rows_[row][static_cast<std::size_t>(i)] =
                    static_cast<float>(quadrature(ggx, eta, std::max(s * s * s * s, GlossMixture::kGrazing), sine2));
            }
        }
    });
    // Eavg = integral of E 2 cos dcos = integral of E(s) 8 s^7 ds, for the table's straight pieces; each is cut finely
    // enough for Simpson's rule to be exact to float rounding.
    const Row all = meanRow();
    double mean = 0.0;
    constexpr int kCuts = 16;
    const auto integrand = [&all](double s) {
        return static_cast<double>(between(all, static_cast<float>(s * s * s * s))) * 8.0 * std::pow(s, 7.0);
    };
    const int pieces = (kNodes - 1) * kCuts;
    for (int i = 0; i < pieces; ++i) {
        const double a = static_cast<double>(i) / pieces;
        const double b = static_cast<double>(i + 1) / pieces;
        mean += (b - a) / 6.0 * (integrand(a) + 4.0 * integrand(0.5 * (a + b)) + integrand(b));
    }
    one_minus_mean_ = static_cast<float>(1.0 - mean);
}

AlbedoTable::Row AlbedoTable::meanRow() const {
    if (rows_.size() == 1) return rows_.front();
    constexpr int kSteps = 4096;
    std::array<double, kAzimuths> weights{};
    for (int step = 0; step < kSteps; ++step) {
        const double sine = std::sin((step + 0.5) / kSteps * 0.5 * static_cast<double>(kPi));
        const double row = sine * sine * (kAzimuths - 1);
        const int n = std::min(static_cast<int>(row), kAzimuths - 2);
        weights[static_cast<std::size_t>(n)] += (n + 1 - row) / kSteps;
        weights[static_cast<std::size_t>(n) + 1] += (row - n) / kSteps;
    }
    Row mean{};
    for (std::size_t i = 0; i < mean.size(); ++i) {
        double sum = 0.0;
        for (std::size_t row = 0; row < weights.size(); ++row) sum += weights[row] * static_cast<double>(rows_[row][i]);
        mean[i] = static_cast<float>(sum);
    }
    return mean;
}

}  // namespace stratum::shade
#endif  // HWY_ONCE
