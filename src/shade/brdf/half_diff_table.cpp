#include "shade/brdf/half_diff_table.h"

#include "base/parallel_for.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::shade {

void HalfDiffTable::directionsOf(int half, int diff, int turn, glm::dvec3& wo, glm::dvec3& wi) {
    const double warped = (half + 0.5) / kHalf;
    const double th = 0.5 * std::numbers::pi * warped * warped;
    const double td = 0.5 * std::numbers::pi * (diff + 0.5) / kDiff;
    const double pd = std::numbers::pi * (turn + 0.5) / kTurn;
    // About the half vector: h, the tangent that points down from the normal, and the binormal.
    const glm::dvec3 h(std::sin(th), 0.0, std::cos(th));
    const glm::dvec3 t(std::cos(th), 0.0, -std::sin(th));
    const glm::dvec3 b(0.0, 1.0, 0.0);
    const glm::dvec3 across = std::cos(pd) * t + std::sin(pd) * b;
    wi = std::cos(td) * h + std::sin(td) * across;
    wo = std::cos(td) * h - std::sin(td) * across;
}

HalfDiffTable HalfDiffTable::bake(const std::function<glm::dvec3(const glm::dvec3&, const glm::dvec3&)>& brdf) {
    std::vector<Color> values(kCells);
    constexpr std::size_t kRows = std::size_t{kHalf} * kDiff;
    parallelFor(kRows, 64, [&](std::size_t first, std::size_t last) {
        for (std::size_t row = first; row != last; ++row) {
            for (int turn = 0; turn < kTurn / 2; ++turn) {
                glm::dvec3 wo;
                glm::dvec3 wi;
                directionsOf(static_cast<int>(row / kDiff), static_cast<int>(row % kDiff), turn, wo, wi);
                const Color value(brdf(wo, wi));
                values[row * kTurn + static_cast<std::size_t>(turn)] = value;
                values[row * kTurn + static_cast<std::size_t>(kTurn - 1 - turn)] = value;
            }
        }
    });
    return HalfDiffTable(std::move(values));
}

Color HalfDiffTable::at(const glm::vec3& wo, const glm::vec3& wi) const {
    const glm::vec3 h = glm::normalize(wo + wi);
    // Angles by atan2: acos is inaccurate near 0, where the highlight is. Differences are symmetric in wo and wi, so
    // that f(a, b) and f(b, a) are bit-identical.
    const float th = std::atan2(std::sqrt(h.x * h.x + h.y * h.y), h.z);
    const glm::vec3 d = 0.5f * (wi - wo);
    const float td = std::atan2(glm::length(d), 0.5f * glm::length(wo + wi));
    // The rotation: d in the tangent and binormal of h. At h = n it is arbitrary.
    const float s = std::sqrt(h.x * h.x + h.y * h.y);
    float pd = 0.0f;
    if (s > 0.0f) {
        float along = (d.x * h.x + d.y * h.y) * h.z / s - d.z * s;
        float across = (d.y * h.x - d.x * h.y) / s;
        if (across < 0.0f || (across == 0.0f && along < 0.0f)) {
            across = -across;
            along = -along;
        }
        pd = std::atan2(across, along);
    }
    const float x = std::sqrt(th * static_cast<float>(2.0 / std::numbers::pi)) * kHalf - 0.5f;
    const float y = td * static_cast<float>(2.0 / std::numbers::pi) * kDiff - 0.5f;
    float z = pd * static_cast<float>(1.0 / std::numbers::pi) * kTurn - 0.5f;
    const auto split = [](float v, int count, int& low) {
        const float clamped = std::clamp(v, 0.0f, static_cast<float>(count - 1));
        low = std::min(static_cast<int>(clamped), count - 2);
        return clamped - static_cast<float>(low);
    };
    int i = 0;
    int j = 0;
    const float wx = split(x, kHalf, i);
    const float wy = split(y, kDiff, j);
    if (z < 0.0f) z += kTurn;
    const int k0 = std::min(static_cast<int>(z), kTurn - 1);
    const int k1 = k0 + 1 == kTurn ? 0 : k0 + 1;
    const float wz = z - static_cast<float>(k0);
    const auto row = [&](int half, int diff) {
        const Color* c = &values_[(static_cast<std::size_t>(half) * kDiff + static_cast<std::size_t>(diff)) * kTurn];
        return (1.0f - wz) * c[k0] + wz * c[k1];
    };
    return (1.0f - wx) * ((1.0f - wy) * row(i, j) + wy * row(i, j + 1)) +
           wx * ((1.0f - wy) * row(i + 1, j) + wy * row(i + 1, j + 1));
}

}  // namespace stratum::shade
