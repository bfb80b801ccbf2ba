// A rough surface between air and a clear solid: reflection and refraction by GGX microfacets, without loss of energy.
//
// Each side has a frame of its own: z is the normal towards that side, x and y are common. So every direction leaves
// the surface with z > 0, and a ray that goes straight through keeps x and y with another sign.
//
// Radiance is divided by the square of the index of refraction of the medium it is in ("basic radiance"): a path that
// begins and ends in air then needs no factor for what lies between.
//
// What single reflections and refractions at the facets lose to further ones, M(side, cosine), is tabulated and given
// back as a diffuse lobe to either side, so that every albedo is 1 to the table's accuracy.
// Sources: B. Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007; the diffuse lobes by
// C. Kelemen, L. Szirmay-Kalos, EG 2001, for both sides with the reciprocity of basic radiance.
#pragma once

#include "shade/brdf/microfacet.h"

#include <array>
#include <cstddef>
#include <optional>

namespace stratum::shade {

enum class Side { air = 0, solid = 1 };
inline Side opposite(Side side) { return side == Side::air ? Side::solid : Side::air; }

/// A direction drawn by RoughInterface::sample.
struct InterfaceSample {
    Side side = Side::air;  ///< where it goes
    glm::vec3 wi{0.0f};     ///< unit, in the frame of that side, z > 0
    float pdf = 0.0f;       ///< per steradian, > 0
};

class RoughInterface {
public:
    /// @param eta    index of refraction of the solid, in [1.05, 3]
    /// @param alpha  GGX's, in [0.001, 1]
    RoughInterface(float eta, float alpha);

    /// Scattering of light from `wi` (frame of `to`) to `wo` (frame of `from`), 1/sr, without a cosine. 0 unless both
    /// z are positive. Divided by the square of the index on the light's side, it is symmetric.
    float eval(Side from, const glm::vec3& wo, Side to, const glm::vec3& wi) const;
    /// Density of sample(): the value times the cosine of wi, so that a sample's weight is 1. The sides share it.
    float pdf(Side from, const glm::vec3& wo, Side to, const glm::vec3& wi) const {
        return eval(from, wo, to, wi) * wi.z;
    }
    /// Draws a visible facet, then whether it reflects, then whether the direction is masked; if so, a diffuse lobe.
    /// @param lobe, u  uniform in [0, 1)^2
    std::optional<InterfaceSample> sample(Side from, const glm::vec3& wo, glm::vec2 lobe, const glm::vec2& u) const;

    float eta() const { return eta_; }
    float alpha() const { return ggx_.along(); }
    /// What the facets' single scattering loses.
    /// @param cosine  to the normal, in [0, 1]
    float lost(Side side, float cosine) const;

private:
    /// Values of single scattering at the facets.
    float reflection(Side from, const glm::vec3& wo, const glm::vec3& wi) const;
    float refraction(Side from, const glm::vec3& wo, const glm::vec3& wi) const;
    /// A direction by visible facets, with what is not masked of it; nothing on the wrong side.
    struct Facet {
        Side side;
        glm::vec3 wi;
        float seen;
    };
    std::optional<Facet> sampleFacet(Side from, const glm::vec3& wo, float& lobe, const glm::vec2& u) const;
    glm::vec3 sampleDiffuse(Side to, float cosine_draw, float angle_draw) const;
    /// Index on that side over the one on the other.
    float ratio(Side from) const { return from == Side::air ? 1.0f / eta_ : eta_; }
    float fresnel(Side from, float cosine) const;
    /// Of light that the facets pass on among themselves, the share that leaves to this side.
    float share(Side to) const { return share_[static_cast<std::size_t>(to)]; }
    double singleAlbedo(Side from, float cosine) const;

    static constexpr int kNodes = 129;  // in cosine^(1/4), as of Plastic, but finer: total reflection begins at a kink
    float eta_;
    Ggx ggx_;
    std::array<std::array<float, kNodes>, 2> lost_{};
    std::array<float, 2> mean_lost_{};
    static constexpr int kSteps = 1024;                     // in cosine^(1/4)
    std::array<std::array<float, kSteps + 1>, 2> below_{};  // of the diffuse lobe, the share below a cosine
    std::array<float, 2> share_{};
};

}  // namespace stratum::shade
