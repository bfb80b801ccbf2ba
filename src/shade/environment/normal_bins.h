// Bins of surface normals, for tables that depend on the normal.
//
// Octahedral map: Q. Meyer et al., "On Floating-Point Normal Vectors", EGSR 2010.
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace stratum::shade {

struct NormalBins {
    static constexpr int kSide = 16;  ///< of the octahedron's square: bins are some 12 degrees wide
    static constexpr int kCount = kSide * kSide;

    /// In [0, kCount).
    /// @param normal  finite, of any length but 0
    static int of(const glm::vec3& normal) {
        const auto [x, y] = folded(normal);
        const auto cell = [](float v) { return std::clamp(static_cast<int>((0.5f * v + 0.5f) * kSide), 0, kSide - 1); };
        return cell(y) * kSide + cell(x);
    }

    /// The point of the octahedral square, [-1, 1]^2, of a direction.
    static std::pair<float, float> folded(const glm::vec3& direction) {
        const float sum = std::abs(direction.x) + std::abs(direction.y) + std::abs(direction.z);
        const float x = direction.x / sum;
        const float y = direction.y / sum;
        if (!(direction.z < 0.0f)) return {x, y};
        return {std::copysign(1.0f - std::abs(y), x), std::copysign(1.0f - std::abs(x), y)};
    }
    /// A normal of a bin.
    /// @param uv  in the bin's square, [0, 1]^2
    static glm::vec3 normal(int bin, const glm::vec2& uv) {
        const int row = bin / kSide;
        const float x = 2.0f * (static_cast<float>(bin % kSide) + uv.x) / kSide - 1.0f;
        const float y = 2.0f * (static_cast<float>(row) + uv.y) / kSide - 1.0f;
        const float z = 1.0f - std::abs(x) - std::abs(y);
        if (z >= 0.0f) return glm::normalize(glm::vec3(x, y, z));
        return glm::normalize(glm::vec3(std::copysign(1.0f - std::abs(y), x), std::copysign(1.0f - std::abs(x), y), z));
    }
};

}  // namespace stratum::shade
