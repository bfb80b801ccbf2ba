#include "shade/finish/glitter.h"

#include "shade/brdf/gloss_mixture.h"
#include "shade/camera/sampling.h"
#include "shade/palette/filament_color.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace stratum::shade {
namespace {

/// GGX's density of slopes.
float slopeDensity(const glm::vec2& slope, float alpha) {
    const float k = 1.0f + (slope.x * slope.x + slope.y * slope.y) / (alpha * alpha);
    return 1.0f / (kPi * alpha * alpha * k * k);
}

glm::vec2 drawSlope(const glm::vec2& u, float alpha) {
    const float radius = alpha * std::sqrt(u.x / std::max(1.0f - u.x, 1e-7f));
    return {radius * std::cos(2.0f * kPi * u.y), radius * std::sin(2.0f * kPi * u.y)};
}

/// The finalizer of SplitMix64 (G. Steele et al., OOPSLA 2014).
std::uint64_t mixed(std::uint64_t x) {
    x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27U)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31U);
}

float fraction(std::uint64_t bits) { return static_cast<float>(bits >> 40U) * 0x1p-24f; }

}  // namespace

float FlakePair::density(const glm::vec3& h) const {
    const glm::vec2 slope(h.x / h.z, h.y / h.z);
    const float z2 = h.z * h.z;
    return 0.5f * (slopeDensity(slope - slope_, alpha_) + slopeDensity(slope + slope_, alpha_)) / (z2 * z2);
}

Color FlakePair::eval(const glm::vec3& wo, const glm::vec3& wi) const {
    if (!(GlossMixture::above(wo) && GlossMixture::above(wi))) return Color(0.0f);
    const glm::vec3 h = glm::normalize(wo + wi);
    // wo.h and wi.h are equal except for rounding; with their mean f(a, b) and f(b, a) are bit-identical.
    const float c = std::clamp(0.5f * (glm::dot(wo, h) + glm::dot(wi, h)), 1e-6f, 1.0f);
    const float off = 1.0f - c;
    const float grazing = off * off * off * off * off;
    const float seen = std::min(1.0f, 2.0f * h.z * std::min(wo.z, wi.z) / c);
    return (color_ + (Color(1.0f) - color_) * grazing) * (density(h) * seen / (4.0f * wo.z * wi.z));
}

float FlakePair::pdf(const glm::vec3& wo, const glm::vec3& wi) const {
    if (!(GlossMixture::above(wo) && GlossMixture::above(wi))) return 0.0f;
    const glm::vec3 h = glm::normalize(wo + wi);
    return density(h) * h.z / (4.0f * std::max(glm::dot(wo, h), 1e-6f));
}

std::optional<BrdfSample> FlakePair::sample(const glm::vec3& wo, float lobe, const glm::vec2& u) const {
    if (!GlossMixture::above(wo)) return std::nullopt;
    const glm::vec2 slope = drawSlope(u, alpha_) + (lobe < 0.5f ? slope_ : -slope_);
    const glm::vec3 h = glm::normalize(glm::vec3(slope, 1.0f));
    const float c = glm::dot(wo, h);
    if (!(c > 0.0f)) return std::nullopt;
    const glm::vec3 wi = glm::normalize(2.0f * c * h - wo);
    const float density = pdf(wo, wi);
    if (!(density > 0.0f && std::isfinite(density))) return std::nullopt;
    return BrdfSample{wi, eval(wo, wi), density};
}

Flakes FlakePair::flakes() const {
    constexpr float kCoat = 0.04f;  // of plastic from above
    return {luminance(color_) / kCoat, slope_};
}

Flakes Glitter::Spot::flakes() const {
    const Flakes all = flakes_.flakes();
    return {share_ * all.strength, all.slope};
}

Color Glitter::Spot::eval(const glm::vec3& wo, const glm::vec3& wi) const {
    return share_ * flakes_.eval(wo, wi) + (1.0f - share_) * plastic_->eval(wo, wi);
}

float Glitter::Spot::pdf(const glm::vec3& wo, const glm::vec3& wi) const {
    return share_ * flakes_.pdf(wo, wi) + (1.0f - share_) * plastic_->pdf(wo, wi);
}

std::optional<BrdfSample> Glitter::Spot::sample(const glm::vec3& wo, float lobe, const glm::vec2& u) const {
    const std::optional<BrdfSample> drawn = lobe < share_ ? flakes_.sample(wo, lobe / share_, u)
                                                          : plastic_->sample(wo, (lobe - share_) / (1.0f - share_), u);
    if (!drawn) return std::nullopt;
    return BrdfSample{drawn->wi, eval(wo, drawn->wi), pdf(wo, drawn->wi)};
}

Glitter::Glitter(const Color& body, double size)
    : size_(size), plastic_(std::make_shared<Plastic>(body, kFilamentAlpha)) {
    constexpr float kSilver = 0.9f;
    constexpr float kTint = 0.4f;
    constexpr float kSteepest = 0.7f;  // tan 35 degrees: steeper ones would mirror light into the plastic, and be dark
    constexpr float kKept =            // of the distribution
        kSteepest * kSteepest / (kSteepest * kSteepest + kSpread * kSpread);
    const Color color = kSilver * ((1.0f - kTint) * Color(1.0f) + kTint * body);
    kinds_.reserve(kKinds);
    for (std::size_t n = 0; n < kKinds; ++n) {
        const std::uint64_t bits = mixed(2 * n + 1);
        // Evenly by radius, so that the kinds together have the distribution.
        const float share = kKept * (static_cast<float>(n) + 0.5f) / static_cast<float>(kKinds);
        kinds_.emplace_back(plastic_, FlakePair(color, drawSlope({share, fraction(bits)}, kSpread), kFlakeAlpha),
                            n % kEvery == 0 ? kFlakes : 0.0f);
    }
}

const Brdf& Glitter::at(const glm::dvec3& place) const {
    std::uint64_t bits = 0;
    for (int axis = 0; axis < 3; ++axis) {
        // A place that is no number, or far outside of any print, is as good as another.
        const double cell = std::floor(place[axis] / size_);
        const auto number = std::abs(cell) < 1e15 ? static_cast<std::int64_t>(cell) : 0;
        bits = mixed(bits + static_cast<std::uint64_t>(number) + 0x9e3779b97f4a7c15ULL);
    }
    return kinds_[bits % kKinds];
}

Color Glitter::eval(const glm::vec3& wo, const glm::vec3& wi) const {
    Color sum(0.0f);
    for (const Spot& spot : kinds_) sum += spot.eval(wo, wi);
    return sum / static_cast<float>(kKinds);
}

float Glitter::pdf(const glm::vec3& wo, const glm::vec3& wi) const {
    float sum = 0.0f;
    for (const Spot& spot : kinds_) sum += spot.pdf(wo, wi);
    return sum / static_cast<float>(kKinds);
}

std::optional<BrdfSample> Glitter::sample(const glm::vec3& wo, float lobe, const glm::vec2& u) const {
    const float scaled = lobe * static_cast<float>(kKinds);
    const std::size_t kind = std::min(static_cast<std::size_t>(scaled), kKinds - 1);
    const auto drawn = kinds_[kind].sample(wo, scaled - static_cast<float>(kind), u);
    if (!drawn) return std::nullopt;
    return BrdfSample{drawn->wi, eval(wo, drawn->wi), pdf(wo, drawn->wi)};
}

std::shared_ptr<const Brdf> Glitter::recolored(const Color& body) const {
    return std::make_shared<Glitter>(body, size_);
}

}  // namespace stratum::shade
