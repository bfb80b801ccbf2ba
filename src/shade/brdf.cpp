#include "shade/brdf.h"

#include "io/error.h"
#include "shade/lambert.h"
#include "shade/plastic.h"
#include "shade/preset.h"

#include <fmt/format.h>

namespace stratum::shade {

const char* const kDefaultBrdf = "plastic:0.82,0.21,0.03,0.22";

std::shared_ptr<const Brdf> makeBrdf(std::string_view text) {
    constexpr std::string_view kOption = "--brdf";
    const Preset preset = parsePreset(text, kOption);
    const auto colour = [&] {
        for (std::size_t i = 0; i < 3; ++i) requireRange(preset, i, 0.0f, 1.0f, kOption, "a reflectance");
        return Color(preset.values[0], preset.values[1], preset.values[2]);
    };
    if (preset.name == "lambert") {
        requireValues(preset, 3, kOption, "lambert:R,G,B");
        return std::make_shared<Lambert>(colour());
    }
    if (preset.name == "plastic") {
        requireValues(preset, 4, kOption, "plastic:R,G,B,ALPHA");
        requireRange(preset, 3, Plastic::kMinAlpha, 1.0f, kOption, "ALPHA (GGX)");
        return std::make_shared<Plastic>(colour(), preset.values[3]);
    }
    throw UsageError(fmt::format("{} {}: unknown material; write lambert:R,G,B or plastic:R,G,B,ALPHA", kOption, text));
}

}  // namespace stratum::shade
