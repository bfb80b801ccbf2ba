// What a rough surface of GGX facets reflects of the light of one direction, as a table.
#pragma once

#include "shade/brdf/microfacet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace stratum::shade {

/// The directional albedo E of light that is reflected once, and its mean. What E lacks of the facets' own reflectance
/// is reflected more than once; (1 - E(o)) (1 - E(i)) / (pi (1 - Eavg)) is a reciprocal lobe that has just the albedo
/// 1 - E. Of facets that are rougher across than along, E depends on the azimuth, and is tabulated by it. Sources: C.
/// Kelemen, L. Szirmay-Kalos, EG 2001; A. Kulla, A. Conty, SIGGRAPH course 2017.
class AlbedoTable {
public:
    /// Of a smooth dielectric's facets.
    /// @param eta  index of refraction inside / outside, > 1
    static AlbedoTable ofDielectric(const Ggx& ggx, float eta) { return {ggx, eta}; }
    /// Of facets that reflect all light.
    static AlbedoTable ofMirrors(const Ggx& ggx) { return {ggx, 0.0f}; }

    /// E.
    /// @param w  unit, local frame, w.z in [0, 1]
    float at(const glm::vec3& w) const {
        if (rows_.size() == 1) return between(rows_.front(), w.z);
        const float sine2 = w.x * w.x + w.y * w.y;
        const float row = sine2 > 0.0f ? w.y * w.y / sine2 * (kAzimuths - 1) : 0.0f;
        const int n = std::min(static_cast<int>(row), kAzimuths - 2);
        const float share = row - static_cast<float>(n);
        const auto below = static_cast<std::size_t>(n);
        return (1.0f - share) * between(rows_[below], w.z) + share * between(rows_[below + 1], w.z);
    }
    /// 1 - Eavg.
    float oneMinusMean() const { return one_minus_mean_; }
    /// The lobe of what E lacks, 1/sr.
    float rest(const glm::vec3& wo, const glm::vec3& wi) const {
        if (!(one_minus_mean_ > 0.0f)) return 0.0f;
        return (1.0f - at(wo)) * (1.0f - at(wi)) / one_minus_mean_ * kInvPi;
    }

private:
    static constexpr int kNodes = 65;  // in cosine^(1/4): a smooth surface's E changes where the cosine is about alpha
    static constexpr int kAzimuths = 9;  // in sin^2 of the azimuth
    using Row = std::array<float, kNodes>;

    /// @param eta  0: all light is reflected
    AlbedoTable(const Ggx& ggx, float eta);
    /// E of a row.
    static float between(const Row& row, float cosine) {
        const float s = std::sqrt(std::sqrt(std::clamp(cosine, 0.0f, 1.0f))) * (kNodes - 1);
        const int i = std::min(static_cast<int>(s), kNodes - 2);
        const float w = s - static_cast<float>(i);
        const auto n = static_cast<std::size_t>(i);
        return (1.0f - w) * row[n] + w * row[n + 1];
    }
    /// The mean of the rows over the azimuth.
    Row meanRow() const;

    std::vector<Row> rows_;  // by sin^2 of the azimuth; one where the facets are isotropic
    float one_minus_mean_ = 1.0f;
};

}  // namespace stratum::shade
