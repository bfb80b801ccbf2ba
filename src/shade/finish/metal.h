// Rough metal: light is reflected by its surface alone, in the colour of the metal.
#pragma once

#include "shade/brdf/albedo_table.h"
#include "shade/brdf/brdf.h"
#include "shade/brdf/gloss_mixture.h"
#include "shade/brdf/microfacet.h"

namespace stratum::shade {

/// f = F D G2 / (4 cos cos) + M (1 - E(o)) (1 - E(i)) / (pi (1 - Eavg)), with Schlick's F from the colour at normal
/// incidence to white at grazing angles. The second term is light that is reflected between facets more than once: E is
/// what white facets reflect once (AlbedoTable), M = Favg^2 Eavg / (1 - Favg (1 - Eavg)) what the colour leaves of the
/// further reflections. Without it a white metal would lose 8 % from above at alpha 0.25, and ln 2 at alpha 1; with it
/// its albedo is 1. Sources: as microfacet.h; C. Schlick, "An Inexpensive BRDF Model for Physically-based Rendering",
/// EG 1994; A. Kulla, A. Conty, SIGGRAPH course 2017, with the square of S. Hill, "A Multi-Faceted Exploration", 2018.
class Metal final : public Brdf {
public:
    /// @param color  reflectance at normal incidence, in [0, 1]
    /// @param alpha  GGX's alpha, in [Plastic::kMinAlpha, 1]
    Metal(const Color& color, float alpha);
    Color eval(const glm::vec3& wo, const glm::vec3& wi) const override;
    std::optional<BrdfSample> sample(const glm::vec3& wo, float lobe, const glm::vec2& u) const override;
    float pdf(const glm::vec3& wo, const glm::vec3& wi) const override;
    std::shared_ptr<const Brdf> recolored(const Color& body) const override;

private:
    void setColor(const Color& color);
    GlossMixture mixture(const glm::vec3& wo) const;

    Color color_{0.0f};
    Color further_{0.0f};  // M
    Ggx ggx_;
    AlbedoTable once_;  // of white facets
};

}  // namespace stratum::shade
