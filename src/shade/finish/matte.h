// Matte plastic: a rough diffuse surface without a coat.
#pragma once

#include "shade/brdf/brdf.h"

namespace stratum::shade {

/// The energy-preserving Oren-Nayar model: facets that are Lambertian themselves, seen and lit as facets of a rough
/// surface are, and the light that goes from facet to facet. Reciprocal; with a white body the albedo is 1 at any
/// angle.
/// Source: J. Portsmouth, P. Kutz, S. Hill, "EON: A Practical Energy-Preserving Rough Diffuse BRDF", JCGT 14(1) 2025,
/// after Y. Fujii's form of M. Oren, S. Nayar, SIGGRAPH 1994.
class Matte final : public Brdf {
public:
    /// Of `matte:R,G,B`: clearly rough, with room above.
    static constexpr float kRoughness = 0.8f;

    /// @param body       reflectance of the facets, in [0, 1]
    /// @param roughness  0: Lambertian, 1: the roughest of the model
    explicit Matte(const Color& body, float roughness = kRoughness);
    Color eval(const glm::vec3& wo, const glm::vec3& wi) const override;
    std::optional<BrdfSample> sample(const glm::vec3& wo, float lobe, const glm::vec2& u) const override;
    float pdf(const glm::vec3& wo, const glm::vec3& wi) const override;
    std::shared_ptr<const Brdf> recolored(const Color& body) const override;

private:
    /// Albedo of the first scattering of a white surface.
    float firstAlbedo(float cosine) const;

    Color body_;
    float roughness_;
    float scale_;  // A of Fujii's form
    float mean_;   // of firstAlbedo() over the hemisphere
    Color again_;  // body color of the light that is scattered more than once
};

}  // namespace stratum::shade
