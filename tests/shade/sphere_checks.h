// What every light must satisfy that draws directions, as numbers that a test can compare.
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

namespace stratum::test {

/// Pearson's chi-squared of draws against a density over the sphere, as a z score (about N(0, 1) when they agree), on
/// cells of latitude and longitude about an axis. Draws of nothing are one more cell; cells that expect few are pooled.
/// @param axis      unit; the cells lie about it
/// @param widest    angle to the axis within which cells lie, radians: small for lights that are small
/// @param draw      of u in [0, 1)^2
/// @param density   per steradian
inline double chiSquaredZ(const glm::vec3& axis, double widest,
                          const std::function<std::optional<glm::vec3>(const glm::vec2&)>& draw,
                          const std::function<double(const glm::vec3&)>& density, int draws, unsigned seed) {
    constexpr int kZ = 16;
    constexpr int kPhi = 32;
    constexpr int kCuts = 40;
    const glm::dvec3 z(axis);
    const glm::dvec3 x = glm::normalize(glm::cross(z, std::abs(z.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0)));
    const glm::dvec3 y = glm::cross(z, x);
    std::vector<double> expected(kZ * kPhi + 1, 0.0);
    std::vector<double> seen(expected.size(), 0.0);
    double inside = 0.0;
    for (int i = 0; i < kZ * kCuts; ++i) {
        const double theta = widest * (i + 0.5) / (kZ * kCuts);
        const double s = std::sin(theta);
        const double c = std::cos(theta);
        for (int j = 0; j < kPhi * kCuts; ++j) {
            const double phi = 2.0 * std::numbers::pi * (j + 0.5) / (kPhi * kCuts);
            const double p = density(glm::vec3(s * std::cos(phi) * x + s * std::sin(phi) * y + c * z)) * s * widest *
                             2.0 * std::numbers::pi / (double(kZ) * kPhi * kCuts * kCuts);
            expected[std::size_t(i / kCuts * kPhi + j / kCuts)] += p * draws;
            inside += p;
        }
    }
    expected.back() = std::max(0.0, 1.0 - inside) * draws;
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> uniform(0.0f, 0x1.fffffep-1f);
    for (int n = 0; n < draws; ++n) {
        const float ux = uniform(random);
        const std::optional<glm::vec3> d = draw({ux, uniform(random)});
        const double side = d ? glm::dot(glm::dvec3(*d), x) : 0.0;
        const double other = d ? glm::dot(glm::dvec3(*d), y) : 0.0;
        const double theta = d ? std::atan2(std::hypot(side, other), glm::dot(glm::dvec3(*d), z)) : 4.0;
        if (!(theta <= widest)) {
            seen.back() += 1.0;
            continue;
        }
        double phi = std::atan2(other, side);
        if (phi < 0.0) phi += 2.0 * std::numbers::pi;
        const int i = std::min(kZ - 1, int(theta / widest * kZ));
        const int j = std::min(kPhi - 1, int(phi / (2.0 * std::numbers::pi) * kPhi));
        seen[std::size_t(i * kPhi + j)] += 1.0;
    }
    double chi2 = 0.0;
    int cells = 0;
    double few_expected = 0.0;
    double few_seen = 0.0;
    const auto add = [&](double e, double s) {
        chi2 += (s - e) * (s - e) / e;
        ++cells;
    };
    for (std::size_t n = 0; n < expected.size(); ++n) {
        if (expected[n] >= 50.0) {
            add(expected[n], seen[n]);
        } else {
            few_expected += expected[n];
            few_seen += seen[n];
        }
    }
    if (few_expected >= 50.0) add(few_expected, few_seen);
    const double degrees = std::max(cells - 1, 1);
    return (chi2 - degrees) / std::sqrt(2.0 * degrees);
}

}  // namespace stratum::test
