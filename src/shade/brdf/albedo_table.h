// What a rough surface of GGX facets reflects of the light of one direction, as a table.
#pragma once

#include "shade/brdf/gloss_mixture.h"
#include "shade/brdf/microfacet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace stratum::shade {

/// The directional albedo E of light that is reflected once, and its mean. What E lacks of the facets' own reflectance
/// is reflected more than once; (1 - E(o)) (1 - E(i)) / (pi (1 - Eavg)) is a reciprocal lobe that has just the albedo
/// 1 - E. Sources: C. Kelemen, L. Szirmay-Kalos, EG 2001; A. Kulla, A. Conty, SIGGRAPH course 2017.
class AlbedoTable {
public:
    /// How facets are drawn for the table: evenly, or closer where they are steep, which lose light from a sharp limit
    /// on; that matters where all of the light is reflected.
    enum class Facets { even, steep };
    /// @param fresnel  float(float): reflectance of a facet by the cosine of the angle to it
    template <typename Fresnel>
    AlbedoTable(const Ggx& ggx, Facets facets, const Fresnel& fresnel) {
        for (int i = 0; i < kNodes; ++i) {
            const float s = static_cast<float>(i) / (kNodes - 1);
            table_[static_cast<std::size_t>(i)] =
                static_cast<float>(quadrature(ggx, facets, fresnel, std::max(s * s * s * s, GlossMixture::kGrazing)));
        }
        // Eavg = integral of E 2 cos dcos = integral of E(s) 8 s^7 ds, for the table's straight pieces; each is cut
        // finely enough for Simpson's rule to be exact to float rounding.
        double mean = 0.0;
        constexpr int kCuts = 16;
        const auto integrand = [this](double s) {
            return static_cast<double>(at(static_cast<float>(s * s * s * s))) * 8.0 * std::pow(s, 7.0);
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
    /// @param cosine  to the normal, in [0, 1]
    float at(float cosine) const {
        const float s = std::sqrt(std::sqrt(std::clamp(cosine, 0.0f, 1.0f))) * (kNodes - 1);
        const int i = std::min(static_cast<int>(s), kNodes - 2);
        const float w = s - static_cast<float>(i);
        const auto n = static_cast<std::size_t>(i);
        return (1.0f - w) * table_[n] + w * table_[n + 1];
    }
    /// 1 - Eavg.
    float oneMinusMean() const { return one_minus_mean_; }
    /// The lobe of what E lacks, 1/sr.
    float rest(float cosine_o, float cosine_i) const {
        if (!(one_minus_mean_ > 0.0f)) return 0.0f;
        return (1.0f - at(cosine_o)) * (1.0f - at(cosine_i)) / one_minus_mean_ * kInvPi;
    }

private:
    /// By quadrature over visible normals, which flattens the integrand for every alpha.
    template <typename Fresnel>
    static double quadrature(const Ggx& ggx, Facets facets, const Fresnel& fresnel, float cosine) {
        constexpr int kRings = 96;
        constexpr int kAngles = 64;
        const glm::vec3 wo(std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)), 0.0f, cosine);
        double sum = 0.0;
        for (int i = 0; i < kRings; ++i) {
            const float v = (static_cast<float>(i) + 0.5f) / kRings;
            const bool even = facets == Facets::even;
            const double weight = even ? 1.0 : static_cast<double>(3.0f * v * v);
            for (int j = 0; j < kAngles; ++j) {
                // wo is in the plane y = 0, so half of the angles are sufficient.
                const glm::vec2 u(0.5f * (static_cast<float>(j) + 0.5f) / kAngles, even ? v : 1.0f - v * v * v);
                const glm::vec3 h = ggx.sampleVisible(wo, u);
                const float c = glm::dot(wo, h);
                const glm::vec3 wi = 2.0f * c * h - wo;
                if (c > 0.0f && wi.z > 0.0f) sum += weight * static_cast<double>(fresnel(c) * ggx.shadowing(wo, wi));
            }
        }
        // The midpoint rule integrates 3 v^2 to 1 - 1 / (4 kRings^2).
        const double whole = facets == Facets::even ? 1.0 : 1.0 - 0.25 / (kRings * kRings);
        return std::min(sum / (kRings * kAngles) / whole, 1.0);
    }

    static constexpr int kNodes = 65;  // in cosine^(1/4): a smooth surface's E changes where the cosine is about alpha
    std::array<float, kNodes> table_{};
    float one_minus_mean_ = 1.0f;
};

}  // namespace stratum::shade
