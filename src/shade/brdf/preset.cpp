#include "shade/brdf/preset.h"

#include "base/error.h"
#include "base/text.h"

#include <fmt/format.h>

#include <cmath>

namespace stratum::shade {

Preset parsePreset(std::string_view text, std::string_view option) {
    Preset preset;
    const std::size_t colon = text.find(':');
    preset.name = text.substr(0, colon);
    if (colon == std::string_view::npos) return preset;
    for (const std::string_view word : split(text.substr(colon + 1))) {
        const auto value = parsed<float>(word);
        if (!value || !std::isfinite(*value))
            throw UsageError(fmt::format("{} {}: '{}' is not a number; write e.g. 0.25", option, text, word));
        preset.values.push_back(*value);
    }
    return preset;
}

void requireValues(const Preset& preset, std::size_t count, std::string_view option, std::string_view form) {
    if (preset.values.size() != count)
        throw UsageError(fmt::format("{} {}: has {} numbers where {} belong; write {}", option, preset.name,
                                     preset.values.size(), count, form));
}

void requireRange(const Preset& preset, std::size_t index, float low, float high, std::string_view option,
                  std::string_view what) {
    const float value = preset.values.at(index);
    if (!(value >= low && value <= high))
        throw UsageError(
            fmt::format("{} {}: {} is {}; it must be from {} to {}", option, preset.name, what, value, low, high));
}

Color bodyColor(const Preset& preset, std::string_view option) {
    for (std::size_t i = 0; i < 3; ++i) requireRange(preset, i, 0.0f, 1.0f, option, "a reflectance");
    return {preset.values[0], preset.values[1], preset.values[2]};
}

}  // namespace stratum::shade
