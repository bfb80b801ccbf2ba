#include "shade/directional.h"

#include "io/error.h"
#include "shade/preset.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

namespace stratum::shade {

DirectionalLight parseDirectionalLight(std::string_view text) {
    constexpr std::string_view kOption = "--light";
    constexpr std::string_view kForm = "directional:X,Y,Z,R,G,B";
    const Preset preset = parsePreset(text, kOption);
    if (preset.name != "directional")
        throw UsageError(fmt::format("{} {}: unknown light; write {}", kOption, text, kForm));
    requireValues(preset, 6, kOption, kForm);
    for (std::size_t i = 3; i < 6; ++i) requireRange(preset, i, 0.0f, 1e6f, kOption, "an irradiance");
    const glm::dvec3 travel(preset.values[0], preset.values[1], preset.values[2]);
    if (!(glm::length(travel) > 0.0))
        throw UsageError(
            fmt::format("{} {}: the direction is zero; write e.g. directional:1,1,-2,3,3,3", kOption, text));
    return {glm::vec3(-glm::normalize(travel)), Color(preset.values[3], preset.values[4], preset.values[5])};
}

}  // namespace stratum::shade
