#include "shade/environment.h"

#include "io/error.h"
#include "shade/constant.h"
#include "shade/preset.h"
#include "shade/sampling.h"
#include "shade/studio.h"

#include <fmt/format.h>

namespace stratum::shade {

std::shared_ptr<const Environment> makeEnvironment(std::string_view text, const EnvironmentPlacement& placement) {
    constexpr std::string_view kOption = "--env";
    const Preset preset = parsePreset(text, kOption);
    if (preset.name == "studio") {
        requireValues(preset, 0, kOption, "studio");
        return std::make_shared<StudioEnvironment>(placement);
    }
    if (preset.name == "constant") {
        requireValues(preset, 3, kOption, "constant:R,G,B");
        for (std::size_t i = 0; i < 3; ++i) requireRange(preset, i, 0.0f, 1e6f, kOption, "a radiance");
        return std::make_shared<ConstantEnvironment>(Color(preset.values[0], preset.values[1], preset.values[2]));
    }
    throw UsageError(fmt::format("{} {}: unknown environment; write studio or constant:R,G,B", kOption, text));
}

Color irradianceFromAbove(const Environment& environment) {
    // Uniform in azimuth and in squared sine, which is the density of the cosine.
    constexpr int kRings = 256;
    constexpr int kAngles = 512;
    glm::dvec3 sum(0.0);
    for (int i = 0; i < kRings; ++i) {
        const double sine2 = (i + 0.5) / kRings;
        const double r = std::sqrt(sine2);
        const double z = std::sqrt(1.0 - sine2);
        for (int j = 0; j < kAngles; ++j) {
            const double phi = 2.0 * std::numbers::pi * (j + 0.5) / kAngles;
            sum += glm::dvec3(environment.radiance(glm::vec3(r * std::cos(phi), r * std::sin(phi), z)));
        }
    }
    return Color(sum * (std::numbers::pi / (kRings * kAngles)));
}

}  // namespace stratum::shade
