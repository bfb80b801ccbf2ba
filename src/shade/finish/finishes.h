// Surfaces of filaments that are sold by their finish: matte, metal and silk (glitter has a file of its own).
#pragma once

#include "shade/brdf/albedo_table.h"
#include "shade/brdf/brdf.h"
#include "shade/brdf/gloss_mixture.h"
#include "shade/brdf/microfacet.h"
#include "shade/brdf/plastic.h"

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

// Rough metal: light is reflected by its surface alone, in the colour of the metal.

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

// Silk filament: plastic with fine pearlescent platelets, which shine in its own color.

/// f = s f_platelets + (1 - s) f_plastic: a mean by area. Each spot, small against a pixel, shows either a platelet, a
/// rough metal of the body's color (Metal), or glossy plastic (plastic.h). Both are reciprocal and none reflects
/// more than it gets, so neither does their mean. The numbers are by eye, of silk PLA beside a lamp; the beads of the
/// print themselves give the streaks along layers.
class Silk final : public Brdf {
public:
    static constexpr float kPlatelets = 0.55f;     ///< s
    static constexpr float kPlateletAlpha = 0.3f;  ///< GGX's, of how they lie
    static constexpr float kPlasticAlpha = 0.1f;

    /// @param body  reflectance of the plastic, and of platelets at normal incidence, in [0, 1]
    explicit Silk(const Color& body) : platelets_(body, kPlateletAlpha), plastic_(body, kPlasticAlpha) {}
    Color eval(const glm::vec3& wo, const glm::vec3& wi) const override;
    std::optional<BrdfSample> sample(const glm::vec3& wo, float lobe, const glm::vec2& u) const override;
    float pdf(const glm::vec3& wo, const glm::vec3& wi) const override;
    std::shared_ptr<const Brdf> recolored(const Color& body) const override;

private:
    Metal platelets_;
    Plastic plastic_;
};

}  // namespace stratum::shade
