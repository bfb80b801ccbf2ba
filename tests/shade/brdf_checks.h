// What every BRDF must satisfy, as numbers that a test can compare.
#pragma once

#include "shade/brdf/brdf.h"
#include "shade/camera/sampler.h"
#include "shade/camera/sampling.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

namespace stratum::test {

inline glm::vec3 direction(double cosine, double azimuth) {
    const double s = std::sqrt(1.0 - cosine * cosine);
    return {s * std::cos(azimuth), s * std::sin(azimuth), cosine};
}

/// The largest difference between eval(a, b) and eval(b, a), over the larger of 1 and the value, of random directions.
inline double asymmetry(const shade::Brdf& brdf) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    double worst = 0.0;
    for (int i = 0; i < 20000; ++i) {
        const glm::vec3 a = direction(uniform(random), 6.28 * uniform(random));
        const glm::vec3 b = direction(uniform(random), 6.28 * uniform(random));
        const shade::Color ab = brdf.eval(a, b);
        const shade::Color ba = brdf.eval(b, a);
        for (int c = 0; c < 3; ++c)
            worst = std::max(worst, double(std::abs(ab[c] - ba[c])) / double(std::max(1.0f, ab[c])));
    }
    return worst;
}

/// Integral of g over the upper hemisphere, midpoint rule in (theta, phi).
inline double overHemisphere(const std::function<double(const glm::vec3&)>& g, int rings, int angles) {
    double sum = 0.0;
    for (int i = 0; i < rings; ++i) {
        const double theta = 0.5 * std::numbers::pi * (i + 0.5) / rings;
        double ring = 0.0;
        for (int j = 0; j < angles; ++j)
            ring += g(direction(std::cos(theta), 2.0 * std::numbers::pi * (j + 0.5) / angles));
        sum += ring * std::sin(theta);
    }
    return sum * (0.5 * std::numbers::pi / rings) * (2.0 * std::numbers::pi / angles);
}

/// Directional albedo of one channel by quadrature.
inline double albedo(const shade::Brdf& brdf, const glm::vec3& wo, int rings = 512, int angles = 512) {
    return overHemisphere([&](const glm::vec3& wi) { return double(brdf.eval(wo, wi).r) * double(wi.z); }, rings,
                          angles);
}

/// Directional albedo of one channel as sample() estimates it: E[f cos / pdf].
inline double sampledAlbedo(const shade::Brdf& brdf, const glm::vec3& wo, std::uint32_t samples = 1u << 18) {
    double sum = 0.0;
    shade::Sampler sampler(1, samples);
    for (std::uint32_t i = 0; i < samples; ++i) {
        sampler.start(i >> 16, 0, i & 0xffffu);
        const float lobe = sampler.next1D();
        if (const auto s = brdf.sample(wo, lobe, sampler.next2D()))
            sum += double(s->f.r) * double(s->wi.z) / double(s->pdf);
    }
    return sum / samples;
}

/// Pearson's chi-squared of sample() against pdf() on cells of equal solid angle, as a z score (about N(0, 1) when they
/// agree; cells that expect few samples are pooled). Samples that return nothing are one more cell.
inline double chiSquaredZ(const shade::Brdf& brdf, const glm::vec3& wo, int samples, unsigned seed) {
    constexpr int kZ = 16;
    constexpr int kPhi = 32;
    constexpr int kCuts = 24;
    std::vector<double> expected(kZ * kPhi + 1, 0.0);
    std::vector<double> seen(expected.size(), 0.0);
    double inside = 0.0;
    for (int i = 0; i < kZ; ++i) {
        for (int j = 0; j < kPhi; ++j) {
            double sum = 0.0;
            for (int a = 0; a < kCuts; ++a)
                for (int b = 0; b < kCuts; ++b)
                    sum += double(brdf.pdf(wo, direction((i + (a + 0.5) / kCuts) / kZ,
                                                         2.0 * std::numbers::pi * (j + (b + 0.5) / kCuts) / kPhi)));
            const double p = sum * 2.0 * std::numbers::pi / (double(kZ) * kPhi * kCuts * kCuts);
            expected[std::size_t(i * kPhi + j)] = p * samples;
            inside += p;
        }
    }
    expected.back() = std::max(0.0, 1.0 - inside) * samples;
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> uniform(0.0f, 0x1.fffffep-1f);
    for (int n = 0; n < samples; ++n) {
        const float lobe = uniform(random);
        const float ux = uniform(random);
        const auto s = brdf.sample(wo, lobe, {ux, uniform(random)});
        if (!s) {
            seen.back() += 1.0;
            continue;
        }
        double phi = std::atan2(double(s->wi.y), double(s->wi.x));
        if (phi < 0.0) phi += 2.0 * std::numbers::pi;
        const int i = std::min(kZ - 1, int(double(s->wi.z) * kZ));
        const int j = std::min(kPhi - 1, int(phi / (2.0 * std::numbers::pi) * kPhi));
        seen[std::size_t(i * kPhi + j)] += 1.0;
    }
    double chi2 = 0.0;
    int cells = 0;
    double pooled_expected = 0.0;
    double pooled_seen = 0.0;
    for (std::size_t c = 0; c < expected.size(); ++c) {
        if (expected[c] < 50.0) {
            pooled_expected += expected[c];
            pooled_seen += seen[c];
            continue;
        }
        chi2 += (seen[c] - expected[c]) * (seen[c] - expected[c]) / expected[c];
        ++cells;
    }
    if (pooled_expected > 50.0) {
        chi2 += (pooled_seen - pooled_expected) * (pooled_seen - pooled_expected) / pooled_expected;
        ++cells;
    }
    const double degrees = cells - 1;
    return (chi2 - degrees) / std::sqrt(2.0 * degrees);
}

}  // namespace stratum::test
