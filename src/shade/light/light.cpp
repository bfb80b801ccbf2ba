#include "shade/light/light.h"

#include "base/error.h"
#include "base/nearest_name.h"
#include "shade/brdf/preset.h"
#include "shade/light/directional.h"
#include "shade/light/point_light.h"
#include "shade/light/rectangle_light.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>

namespace stratum::shade {
namespace {

constexpr std::string_view kLightOption = "--light";

glm::dvec3 vectorAt(const Preset& preset, std::size_t first) {
    return {preset.values[first], preset.values[first + 1], preset.values[first + 2]};
}

Color colorAt(const Preset& preset, std::size_t first, std::string_view what) {
    for (std::size_t i = first; i < first + 3; ++i) requireRange(preset, i, 0.0f, 1e9f, kLightOption, what);
    return Color(vectorAt(preset, first));
}

glm::vec3 towards(const Preset& preset, std::string_view text) {
    const glm::dvec3 travel = vectorAt(preset, 0);
    if (!(glm::length(travel) > 0.0))
        throw UsageError(
            fmt::format("{} {}: the direction is zero; write e.g. {}:1,1,-2,3,3,3", kLightOption, text, preset.name));
    return glm::vec3(-glm::normalize(travel));
}

}  // namespace

std::shared_ptr<const Light> parseLight(std::string_view text) {
    Preset preset = parsePreset(text, kLightOption);
    if (preset.name == "directional") {
        requireValues(preset, 6, kLightOption, "directional:X,Y,Z,R,G,B");
        return std::make_shared<DirectionalLight>(towards(preset, text), colorAt(preset, 3, "an irradiance"));
    }
    if (preset.name == "sun") {
        if (preset.values.size() == 6) preset.values.push_back(SunLight::kRealDiameter);
        requireValues(preset, 7, kLightOption, "sun:X,Y,Z,R,G,B,DEGREES");
        requireRange(preset, 6, 0.01f, 90.0f, kLightOption, "its diameter in degrees");
        return std::make_shared<SunLight>(towards(preset, text), colorAt(preset, 3, "an irradiance"), preset.values[6]);
    }
    if (preset.name == "point") {
        requireValues(preset, 6, kLightOption, "point:X,Y,Z,R,G,B");
        return std::make_shared<PointLight>(vectorAt(preset, 0), colorAt(preset, 3, "an intensity"));
    }
    if (preset.name == "rectangle") {
        requireValues(preset, 12, kLightOption, "rectangle:X,Y,Z,UX,UY,UZ,VX,VY,VZ,R,G,B");
        const glm::dvec3 u = vectorAt(preset, 3);
        const glm::dvec3 v = vectorAt(preset, 6);
        if (!(glm::length(u) > 0.0 && glm::length(v) > 0.0) ||
            std::abs(glm::dot(u, v)) > 1e-4 * glm::length(u) * glm::length(v))
            throw UsageError(
                fmt::format("{} {}: the half edges U and V must be perpendicular and not zero", kLightOption, text));
        return std::make_shared<RectangleLight>(vectorAt(preset, 0), u, v, colorAt(preset, 9, "a radiance"));
    }
    throw UsageError(fmt::format(
        "{} {}: unknown light; write directional:, sun:, point:, rectangle: or ambient: and "
        "numbers, see -h{}",
        kLightOption, text, didYouMean(preset.name, {"directional", "sun", "point", "rectangle", "ambient"})));
}

std::optional<Color> parseAmbient(std::string_view text) {
    if (text.substr(0, text.find(':')) != "ambient") return std::nullopt;
    const Preset preset = parsePreset(text, kLightOption);
    requireValues(preset, 3, kLightOption, "ambient:R,G,B");
    return colorAt(preset, 0, "a radiance");
}

Color irradianceFrom(const Light& light, const glm::dvec3& point, int side) {
    if (!light.hasExtent()) side = 1;
    glm::dvec3 sum(0.0);
    for (int i = 0; i < side; ++i) {
        for (int j = 0; j < side; ++j) {
            const auto s = light.sample(point, {(static_cast<float>(i) + 0.5f) / static_cast<float>(side),
                                                (static_cast<float>(j) + 0.5f) / static_cast<float>(side)});
            if (s && s->direction.z > 0.0f)
                sum += glm::dvec3(s->light * (s->direction.z / (s->pdf > 0.0f ? s->pdf : 1.0f)));
        }
    }
    return Color(sum / static_cast<double>(side * side));
}

}  // namespace stratum::shade
