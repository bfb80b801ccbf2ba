#include "shade/scene/bed.h"

#include "shade/brdf/lambert.h"
#include "shade/brdf/plastic.h"
#include "shade/camera/sampler.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace stratum::shade {
namespace {

/// A hash in [0, 1) for each knot of a lattice.
double knot(std::int64_t x, std::int64_t y) {
    const std::uint32_t h = sobol::hash(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
    return static_cast<double>(h) * 0x1p-32;
}

/// Gradient of value noise: knots one apart, joined by cubics that rest at each.
glm::dvec2 noiseGradient(const glm::dvec2& p) {
    const glm::dvec2 low(std::floor(p.x), std::floor(p.y));
    const glm::dvec2 s = p - low;
    const glm::dvec2 w = s * s * (3.0 - 2.0 * s);
    const glm::dvec2 rise = 6.0 * s * (1.0 - s);
    // Far away, where doubles can't resolve the lattice, the knot is arbitrary.
    const auto x = static_cast<std::int64_t>(std::clamp(low.x, -1e15, 1e15));
    const auto y = static_cast<std::int64_t>(std::clamp(low.y, -1e15, 1e15));
    const double a = knot(x, y);
    const double b = knot(x + 1, y);
    const double c = knot(x, y + 1);
    const double d = knot(x + 1, y + 1);
    return {rise.x * ((1.0 - w.y) * (b - a) + w.y * (d - c)), rise.y * ((1.0 - w.x) * (c - a) + w.x * (d - b))};
}

/// Slope of the powder coat. Two lattices rotated against each other, so that neither is visible.
glm::dvec2 coatSlope(const glm::dvec2& mm) {
    constexpr double kGrain = 0.45;  // mm between knots of the coarser lattice
    constexpr double kFine = 1.7;    // times as many of the finer one
    constexpr double kCos = 0.8;
    constexpr double kSin = 0.6;
    constexpr double kSteepness = 0.35;
    const glm::dvec2 p = mm / kGrain;
    const glm::dvec2 turned = kFine * glm::dvec2(kCos * p.x + kSin * p.y, kCos * p.y - kSin * p.x);
    const glm::dvec2 fine = noiseGradient(turned);
    const glm::dvec2 back(kCos * fine.x - kSin * fine.y, kCos * fine.y + kSin * fine.x);
    return kSteepness * (noiseGradient(p) + back);
}

/// Whether a coordinate lies on one of the lines `period` apart, all in mm.
bool onLine(double v, double period, double width) {
    const double away = std::abs(v - period * std::round(v / period));
    return away <= 0.5 * width;
}

constexpr double kFinePeriod = 10.0, kFineWidth = 0.3, kBroadPeriod = 50.0, kBroadWidth = 0.8;  // mm

bool onGrid(double v) { return onLine(v, kFinePeriod, kFineWidth) || onLine(v, kBroadPeriod, kBroadWidth); }

BedTexture::Finish matt(const Color& color) { return {std::make_shared<Lambert>(color), color}; }

}  // namespace

BedTexture::BedTexture(BedSurface surface, double mm_per_unit) : surface_(surface), mm_per_unit_(mm_per_unit) {
    switch (surface) {
        case BedSurface::paper:
            base_ = matt(Color(0.56f));
            mean_ = base_.albedo;
            break;
        case BedSurface::pei:
            base_.brdf = std::make_shared<Plastic>(Color(0.120f, 0.085f, 0.042f), 0.3f);
            base_.albedo = mean_ = reflectanceFactor(*base_.brdf);
            break;
        case BedSurface::grid: {
            base_ = matt(Color(0.035f, 0.037f, 0.040f));
            lines_ = matt(Color(0.32f, 0.33f, 0.34f));
            // Along one axis, of 50 mm: five lines, one of them broad.
            constexpr double kLine = (4.0 * kFineWidth + kBroadWidth) / kBroadPeriod;
            constexpr auto kShare = static_cast<float>(1.0 - (1.0 - kLine) * (1.0 - kLine));
            mean_ = (1.0f - kShare) * base_.albedo + kShare * lines_.albedo;
            break;
        }
    }
}

BedTexture::BedTexture(const Color& paper) : surface_(BedSurface::paper), base_(matt(paper)), mean_(paper) {}

const BedTexture::Finish& BedTexture::at(const glm::dvec2& place) const {
    if (surface_ != BedSurface::grid) return base_;
    const glm::dvec2 mm = mm_per_unit_ * place;
    return onGrid(mm.x) || onGrid(mm.y) ? lines_ : base_;
}

glm::dvec3 BedTexture::normal(const glm::dvec2& place) const {
    if (!bumpy()) return {0.0, 0.0, 1.0};
    const glm::dvec2 slope = coatSlope(mm_per_unit_ * place);
    return glm::normalize(glm::dvec3(-slope.x, -slope.y, 1.0));
}

Color Backdrop::radiance(const glm::vec3& direction) const {
    const float t = std::clamp(direction.z, 0.0f, 1.0f);
    const float w = t * t * (3.0f - 2.0f * t);
    return (1.0f - w) * horizon + w * zenith;
}

double Bed::fadeAt(double radius) const {
    const double t = std::clamp((radius - fade_begin) / (fade_end - fade_begin), 0.0, 1.0);
    return t * t * t * (t * (6.0 * t - 15.0) + 10.0);
}

}  // namespace stratum::shade
