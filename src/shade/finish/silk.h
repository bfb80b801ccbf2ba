// Silk filament: plastic with fine pearlescent platelets, which shine in its own color.
#pragma once

#include "shade/brdf/brdf.h"
#include "shade/brdf/plastic.h"
#include "shade/finish/metal.h"

namespace stratum::shade {

/// f = s f_platelets + (1 - s) f_plastic: a mean by area. Each spot, small against a pixel, shows either a platelet, a
/// rough metal of the body's color (metal.h), or glossy plastic (plastic.h). Both are reciprocal and none reflects more
/// than it gets, so neither does their mean. The numbers are by eye, of silk PLA beside a lamp; the beads of the print
/// themselves give the streaks along layers.
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
