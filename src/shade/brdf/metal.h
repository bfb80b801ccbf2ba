// Rough metal: light is reflected by its surface alone, in the colour of the metal.
#pragma once

#include "shade/brdf/brdf.h"
#include "shade/brdf/microfacet.h"

namespace stratum::shade {

/// f = F D G2 / (4 cos cos), with Schlick's F from the colour at normal incidence to white at grazing angles. Light
/// that is reflected between facets more than once is lost: from above 8 % at alpha 0.25, and ln 2 at alpha 1
/// (metal_test). Sources: as microfacet.h; C. Schlick, "An Inexpensive BRDF Model for Physically-based Rendering", EG
/// 1994.
class Metal final : public Brdf {
public:
    /// @param color  reflectance at normal incidence, in [0, 1]
    /// @param alpha  GGX's alpha, in [Plastic::kMinAlpha, 1]
    Metal(const Color& color, float alpha) : color_(color), ggx_{alpha} {}
    Color eval(const glm::vec3& wo, const glm::vec3& wi) const override;
    std::optional<BrdfSample> sample(const glm::vec3& wo, float lobe, const glm::vec2& u) const override;
    float pdf(const glm::vec3& wo, const glm::vec3& wi) const override;
    std::shared_ptr<const Brdf> recolored(const Color& body) const override;

private:
    Color color_;
    Ggx ggx_;
};

}  // namespace stratum::shade
