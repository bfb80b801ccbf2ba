// Satin plastic: a colored diffuse body under a rough, colorless dielectric coat, as of printed filament.
#pragma once

#include "shade/brdf/albedo_table.h"
#include "shade/brdf/brdf.h"
#include "shade/brdf/microfacet.h"

namespace stratum::shade {

/// f = F D G2 / (4 cos cos) + kd / pi (1 - E(o)) (1 - E(i)) / (1 - Eavg)
///
/// E is the coat's directional albedo, tabulated at construction, so that energy is conserved: with kd = 1 the albedo
/// is 1 at any angle (to the table's 1e-4; to 1e-3 where alpha differs along and across). Energy of multiple scattering
/// between facets is added to the body. Exact Fresnel, eta 1.5. Source of the coupling: C. Kelemen, L. Szirmay-Kalos,
/// EG 2001; A. Kulla, A. Conty, SIGGRAPH course 2017.
class Plastic final : public Brdf {
public:
    static constexpr float kEta = 1.5f;
    static constexpr float kMinAlpha = 0.001f;

    /// @param body   reflectance of the body, kd, in [0, 1]
    /// @param alpha  GGX's alpha of the coat, in [kMinAlpha, 1]
    Plastic(const Color& body, float alpha) : Plastic(body, Ggx(alpha)) {}
    /// @param coat  its microfacets, of any direction
    Plastic(const Color& body, const Ggx& coat);
    Color eval(const glm::vec3& wo, const glm::vec3& wi) const override;
    std::optional<BrdfSample> sample(const glm::vec3& wo, float lobe, const glm::vec2& u) const override;
    float pdf(const glm::vec3& wo, const glm::vec3& wi) const override;
    std::shared_ptr<const Brdf> recolored(const Color& body) const override;
    /// With a coat of the mean alpha, if the coat's is not the same along and across.
    const Brdf* undirected() const override { return undirected_.get(); }

    /// The coat's directional albedo E.
    float coatAlbedo(const glm::vec3& w) const { return coat_.at(w); }

private:
    /// Probability of drawing from the coat.
    float coatShare(const glm::vec3& wo) const;
    float coat(const glm::vec3& wo, const glm::vec3& wi, const glm::vec3& h) const;

    Color body_;
    float body_max_;
    Ggx ggx_;
    AlbedoTable coat_;
    std::shared_ptr<const Brdf> undirected_;
};

}  // namespace stratum::shade
