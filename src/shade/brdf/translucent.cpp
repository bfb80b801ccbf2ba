#include "shade/brdf/translucent.h"

#include "shade/brdf/plastic.h"
#include "shade/brdf/preset.h"
#include "shade/palette/filament_color.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace stratum::shade {
namespace {

struct NamedMedium {
    std::string_view name;
    Color color;
    double mean_free_path;
};

// Chosen by eye beside photographs of such prints, not measured: no table of their scattering is at hand.
const std::array<NamedMedium, 3> kNamed = {{
    {"natural-pla", {0.78f, 0.74f, 0.64f}, 0.9},
    {"clear-petg", {0.50f, 0.62f, 0.61f}, 5.0},
    {"lithophane-white", {0.90f, 0.89f, 0.86f}, 0.2},
}};

/// Filament's surface. All materials of a scene share it: its tables take 0.1 s.
std::shared_ptr<const RoughInterface> filamentSurface() {
    static const auto surface = std::make_shared<const RoughInterface>(Translucent::kEta, kFilamentAlpha);
    return surface;
}

std::shared_ptr<const Translucent> make(const Color& color, double mean_free_path, float asymmetry) {
    const Medium inside{scatteringAlbedo(color, asymmetry), mean_free_path, asymmetry};
    return std::make_shared<Translucent>(inside, color, filamentSurface());
}

constexpr double kLeastByDistance = 0.02;  // mm

}  // namespace

Color scatteringAlbedo(const Color& color, float asymmetry) {
    constexpr double kP = 0.4944;
    constexpr double kQ = 4.070;
    const auto g = static_cast<double>(asymmetry);
    Color albedo;
    for (int c = 0; c < 3; ++c) {
        const double wanted = std::clamp(static_cast<double>(color[c]), 0.0, 1.0);
        const double b = 1.0 + kP + kQ * wanted;
        const double s = std::clamp((b - std::sqrt(b * b - 4.0 * kP * (1.0 - wanted))) / (2.0 * kP), 0.0, 1.0);
        albedo[c] = static_cast<float>(std::clamp((1.0 - s * s) / (1.0 - g * s * s), 0.0, 1.0));
    }
    return albedo;
}

double meanFreePathOf(double transmission_distance, double albedo) {
    // albedo atanh(k) / k rises with k from the albedo on.
    double low = 0.0;
    double high = 1.0;
    for (int n = 0; n < 60; ++n) {
        const double k = 0.5 * (low + high);
        (albedo * std::atanh(k) < k ? low : high) = k;
    }
    return low * transmission_distance / std::numbers::ln10;
}

Translucent::Translucent(const Medium& inside, const Color& color, std::shared_ptr<const RoughInterface> surface)
    : stand_in_(std::make_shared<Plastic>(color, surface->alpha())),
      surface_(std::move(surface)),
      medium_(inside),
      reflected_(surface_, Side::air),
      transmitted_(surface_, Side::solid) {}

std::shared_ptr<const Brdf> Translucent::recolored(const Color& color) const {
    auto other = std::make_shared<Translucent>(*this);  // the surface's tables don't depend on the color
    other->stand_in_ = stand_in_->recolored(color);
    other->medium_.albedo = scatteringAlbedo(color, medium_.asymmetry);
    return other;
}

std::vector<std::string> translucentNames() {
    std::vector<std::string> names;
    names.reserve(kNamed.size());
    for (const NamedMedium& named : kNamed) names.emplace_back(named.name);
    return names;
}

bool isTranslucent(std::string_view text) {
    return std::any_of(kNamed.begin(), kNamed.end(), [text](const NamedMedium& named) { return named.name == text; });
}

std::shared_ptr<const Translucent> makeTranslucentByDistance(const Preset& preset, std::string_view option) {
    const Color color = bodyColor(preset, option);
    requireRange(preset, 3, 0.1f, 1000.0f, option, "TRANSMISSION_DISTANCE_MM");
    const auto albedo = static_cast<double>(scatteringAlbedo(Color(luminance(color)), 0.0f).r);
    // What scatters more often looks the same, and takes longer.
    return make(color, std::max(meanFreePathOf(static_cast<double>(preset.values[3]), albedo), kLeastByDistance), 0.0f);
}

std::shared_ptr<const Translucent> makeTranslucent(const Preset& preset, std::string_view option) {
    for (const NamedMedium& named : kNamed)
        if (named.name == preset.name) return make(named.color, named.mean_free_path, 0.0f);
    const Color color = bodyColor(preset, option);
    requireRange(preset, 3, Translucent::kMinMeanFreePath, Translucent::kMaxMeanFreePath, option, "MEAN_FREE_PATH_MM");
    if (preset.values.size() == 5)
        requireRange(preset, 4, -Translucent::kMaxAsymmetry, Translucent::kMaxAsymmetry, option,
                     "G (mean cosine of scattering)");
    return make(color, static_cast<double>(preset.values[3]), preset.values.size() == 5 ? preset.values[4] : 0.0f);
}

}  // namespace stratum::shade
