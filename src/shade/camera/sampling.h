// Maps from the unit square to distributions, and weights of multiple importance sampling.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::shade {

inline constexpr float kPi = std::numbers::pi_v<float>;
inline constexpr float kInvPi = std::numbers::inv_pi_v<float>;

/// Uniform on the unit disc; preserves adjacency.
/// Source: P. Shirley, K. Chiu, "A Low Distortion Map Between Disk and Square", JGT 2(3) 1997.
inline glm::vec2 toDisc(const glm::vec2& u) {
    const float a = 2.0f * u.x - 1.0f;
    const float b = 2.0f * u.y - 1.0f;
    if (a == 0.0f && b == 0.0f) return {0.0f, 0.0f};
    const bool wide = std::abs(a) > std::abs(b);
    const float r = wide ? a : b;
    // At most an eighth of a turn: Taylor's series are exact to 3e-8 there, a float's rounding.
    const float phi = 0.25f * kPi * (wide ? b / a : a / b);
    const float p2 = phi * phi;
    const float c = 1.0f - p2 * (1.0f / 2 - p2 * (1.0f / 24 - p2 * (1.0f / 720 - p2 * (1.0f / 40320))));
    const float s = phi * (1.0f - p2 * (1.0f / 6 - p2 * (1.0f / 120 - p2 * (1.0f / 5040 - p2 * (1.0f / 362880)))));
    return wide ? glm::vec2(r * c, r * s) : glm::vec2(r * s, r * c);
}

/// Density z / pi over the hemisphere about +z. May return z = 0 in the corners; density 0, reject it.
inline glm::vec3 toCosineHemisphere(const glm::vec2& u) {
    const glm::vec2 d = toDisc(u);
    return {d.x, d.y, std::sqrt(std::max(0.0f, 1.0f - d.x * d.x - d.y * d.y))};
}

/// Density 1 / (4 pi) over the sphere.
inline glm::vec3 toSphere(const glm::vec2& u) {
    const float z = 1.0f - 2.0f * u.x;
    const float r = std::sqrt(std::max(0.0f, 1.0f - z * z));
    const float phi = 2.0f * kPi * u.y;
    return {r * std::cos(phi), r * std::sin(phi), z};
}

/// Weight of a sample of density `a` when the other strategy has density `b`, one sample each.
/// Source: E. Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997, power heuristic of exponent 2.
inline float powerHeuristic(float a, float b) {
    if (!(a > 0.0f)) return 0.0f;
    // By the ratio, so that large densities don't overflow.
    const float r = b / a;
    return 1.0f / (1.0f + r * r);
}

/// The same by the balance heuristic (Veach): for strategies that were made to complement each other, as compensated
/// maps of light are.
inline float balanceHeuristic(float a, float b) { return a > 0.0f ? 1.0f / (1.0f + b / a) : 0.0f; }

}  // namespace stratum::shade
