// Sampling of a mixture of a glossy and a diffuse lobe, used by all glossy materials.
#pragma once

#include "shade/brdf/brdf.h"
#include "shade/brdf/microfacet.h"

namespace stratum::shade {

/// Directions by visible GGX normals with probability `share`, else by the cosine. Local frame.
struct GlossMixture {
    /// Below this cosine floats can't resolve directions (wo + wi may vanish); no light is scattered there.
    static constexpr float kGrazing = 1e-6f;
    static bool above(const glm::vec3& w) { return w.z > kGrazing; }

    Ggx ggx;
    float share;  ///< of the glossy lobe, in [0, 1]

    /// Per steradian; 0 unless both directions are above the surface.
    float pdf(const glm::vec3& wo, const glm::vec3& wi) const;
    /// A direction with its density, and without a value: f is 0. If it is below the surface its density is 0.
    /// @param lobe, u  as for Brdf::sample
    BrdfSample draw(const glm::vec3& wo, float lobe, const glm::vec2& u) const;
    /// A sample for `brdf`; nothing if it is below the surface.
    std::optional<BrdfSample> sample(const Brdf& brdf, const glm::vec3& wo, float lobe, const glm::vec2& u) const;
};

}  // namespace stratum::shade
