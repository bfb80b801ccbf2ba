// What a rough surface of GGX facets reflects of the light of one direction, as a table.
#pragma once

#include "base/parallel_for.h"
#include "shade/brdf/gloss_mixture.h"
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
    /// How facets are drawn for the table: evenly, or closer where they are steep, which lose light from a sharp limit
    /// on; that matters where all of the light is reflected.
    enum class Facets { even, steep };
    /// @param fresnel  float(float): reflectance of a facet by the cosine of the angle to it
    template <typename Fresnel>
    AlbedoTable(const Ggx& ggx, Facets facets, const Fresnel& fresnel) : rows_(ggx.isotropic() ? 1 : kAzimuths) {
        parallelFor(rows_.size(), 1, [&](std::size_t first, std::size_t last) {
            for (std::size_t row = first; row != last; ++row) {
                const float sine2 = rows_.size() > 1 ? static_cast<float>(row) / (kAzimuths - 1) : 0.0f;
                for (int i = 0; i < kNodes; ++i) {
                    const float s = static_cast<float>(i) / (kNodes - 1);
                    rows_[row][static_cast<std::size_t>(i)] = static_cast<float>(
                        quadrature(ggx, facets, fresnel, std::max(s * s * s * s, GlossMixture::kGrazing), sine2));
                }
            }
        });
        // Eavg = integral of E 2 cos dcos = integral of E(s) 8 s^7 ds, for the table's straight pieces; each is cut
        // finely enough for Simpson's rule to be exact to float rounding.
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

    /// E of a row.
    static float between(const Row& row, float cosine) {
        const float s = std::sqrt(std::sqrt(std::clamp(cosine, 0.0f, 1.0f))) * (kNodes - 1);
        const int i = std::min(static_cast<int>(s), kNodes - 2);
        const float w = s - static_cast<float>(i);
        const auto n = static_cast<std::size_t>(i);
        return (1.0f - w) * row[n] + w * row[n + 1];
    }
    /// The mean of the rows over the azimuth.
    Row meanRow() const {
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
            for (std::size_t row = 0; row < weights.size(); ++row)
                sum += weights[row] * static_cast<double>(rows_[row][i]);
            mean[i] = static_cast<float>(sum);
        }
        return mean;
    }
    /// By quadrature over visible normals, which flattens the integrand for every alpha.
    template <typename Fresnel>
    static double quadrature(const Ggx& ggx, Facets facets, const Fresnel& fresnel, float cosine, float azimuth_sine2) {
        const int rings = ggx.isotropic() ? 96 : 48;
        const int angles = ggx.isotropic() ? 64 : 32;
        const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
        const glm::vec3 wo(sine * std::sqrt(1.0f - azimuth_sine2), sine * std::sqrt(azimuth_sine2), cosine);
        // Half of the angles are sufficient where wo is in a plane of symmetry: then y is 0, or x.
        const bool half = azimuth_sine2 == 0.0f;
        double sum = 0.0;
        for (int i = 0; i < rings; ++i) {
            const float v = (static_cast<float>(i) + 0.5f) / static_cast<float>(rings);
            const bool even = facets == Facets::even;
            const double weight = even ? 1.0 : static_cast<double>(3.0f * v * v);
            for (int j = 0; j < angles; ++j) {
                const glm::vec2 u((half ? 0.5f : 1.0f) * (static_cast<float>(j) + 0.5f) / static_cast<float>(angles),
                                  even ? v : 1.0f - v * v * v);
                const glm::vec3 h = ggx.sampleVisible(wo, u);
                const float c = glm::dot(wo, h);
                const glm::vec3 wi = 2.0f * c * h - wo;
                if (c > 0.0f && wi.z > 0.0f) sum += weight * static_cast<double>(fresnel(c) * ggx.shadowing(wo, wi));
            }
        }
        // The midpoint rule integrates 3 v^2 to 1 - 1 / (4 rings^2).
        const double whole = facets == Facets::even ? 1.0 : 1.0 - 0.25 / (rings * rings);
        return std::min(sum / (rings * angles) / whole, 1.0);
    }

    std::vector<Row> rows_;  // by sin^2 of the azimuth; one where the facets are isotropic
    float one_minus_mean_ = 1.0f;
};

}  // namespace stratum::shade
