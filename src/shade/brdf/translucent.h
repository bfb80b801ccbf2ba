// Plastic that light goes through: a rough surface, and inside it scattering and absorption.
#pragma once

#include "shade/brdf/brdf.h"
#include "shade/brdf/preset.h"
#include "shade/brdf/rough_interface.h"

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stratum::shade {

/// The inside of a translucent solid. The mean free path is the same in all channels; what a scattering event keeps is
/// not.
struct Medium {
    Color albedo{0.0f};           ///< kept by each event, in [0, 1]
    double mean_free_path = 1.0;  ///< mm between events
    float asymmetry = 0.0f;       ///< mean cosine g of the phase function (Henyey, Greenstein 1941), in (-1, 1)
};

/// The albedo of an event, so that a thick piece scatters back `color` of the diffuse light that gets into it.
/// With s^2 = (1 - albedo) / (1 - albedo g), a half space of index 1.465 scatters back (1 - s)(1 - 0.4944 s) / (1 +
/// 4.070 s), which is solved for the albedo. The form is van de Hulst's ("Multiple Light Scattering", 1980); the
/// numbers are fitted to the solution for isotropic scattering by Chandrasekhar's H function ("Radiative Transfer",
/// 1950) between a surface that reflects by Fresnel's equations: at most 0.003 off.
Color scatteringAlbedo(const Color& color, float asymmetry);

/// The mean free path in mm, for isotropic events of that albedo, with which light that has gone deep falls to a tenth
/// in `transmission_distance` mm. That is how HueForge's transmission distance of filaments, which meters measure, is
/// read commonly (T = 10^(-d / TD)). Deep light falls as exp(-k t) with t in free paths and albedo atanh(k) = k, the
/// asymptotic solution of radiative transfer (Case, Zweifel, "Linear Transport Theory", 1967).
double meanFreePathOf(double transmission_distance, double albedo);

/// As a Brdf it is its opaque stand-in, plastic of the same color, for integrators that do not go inside. The path
/// integrator uses the rest.
class Translucent final : public Brdf {
public:
    static constexpr float kEta = 1.465f;                                         ///< of PLA; PETG has 1.57
    static constexpr float kMinMeanFreePath = 0.01f, kMaxMeanFreePath = 1000.0f;  ///< mm
    static constexpr float kMaxAsymmetry = 0.99f;

    /// @param color  of its stand-in
    Translucent(const Medium& inside, const Color& color, std::shared_ptr<const RoughInterface> surface);

    Color eval(const glm::vec3& wo, const glm::vec3& wi) const override { return stand_in_->eval(wo, wi); }
    std::optional<BrdfSample> sample(const glm::vec3& wo, float lobe, const glm::vec2& u) const override {
        return stand_in_->sample(wo, lobe, u);
    }
    float pdf(const glm::vec3& wo, const glm::vec3& wi) const override { return stand_in_->pdf(wo, wi); }
    std::shared_ptr<const Brdf> recolored(const Color& color) const override;
    const Translucent* translucent() const override { return this; }

    const RoughInterface& surface() const { return *surface_; }
    const Medium& medium() const { return medium_; }
    /// How light from the air is scattered to `wo`, which is on that side, in the side's frame (RoughInterface). It has
    /// eval() and pdf() only; sample() is of the surface.
    const Brdf& fromAir(Side side_of_wo) const { return side_of_wo == Side::air ? reflected_ : transmitted_; }

private:
    class AirLight final : public Brdf {
    public:
        AirLight(std::shared_ptr<const RoughInterface> surface, Side side)
            : surface_(std::move(surface)), side_(side) {}
        Color eval(const glm::vec3& wo, const glm::vec3& wi) const override {
            return Color(surface_->eval(side_, wo, Side::air, wi));
        }
        std::optional<BrdfSample> sample(const glm::vec3&, float, const glm::vec2&) const override {
            return std::nullopt;
        }
        float pdf(const glm::vec3& wo, const glm::vec3& wi) const override {
            return surface_->pdf(side_, wo, Side::air, wi);
        }

    private:
        std::shared_ptr<const RoughInterface> surface_;
        Side side_;
    };

    std::shared_ptr<const Brdf> stand_in_;
    std::shared_ptr<const RoughInterface> surface_;
    Medium medium_;
    AirLight reflected_, transmitted_;
};

/// The names of presets.
std::vector<std::string> translucentNames();

/// Whether the text of --brdf is the name of a preset.
bool isTranslucent(std::string_view text);

/// Of R, G, B, TRANSMISSION_DISTANCE_MM: meanFreePathOf() for the luminance. Throws UsageError.
std::shared_ptr<const Translucent> makeTranslucentByDistance(const Preset& preset, std::string_view option);

/// Of R, G, B, MEAN_FREE_PATH_MM and, if there are five numbers, G; or a preset by its name: natural-pla, clear-petg,
/// lithophane-white. Throws UsageError.
std::shared_ptr<const Translucent> makeTranslucent(const Preset& preset, std::string_view option);

}  // namespace stratum::shade
