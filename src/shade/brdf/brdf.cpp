#include "shade/brdf/brdf.h"

#include "base/error.h"
#include "base/nearest_name.h"
#include "shade/brdf/lambert.h"
#include "shade/brdf/metal.h"
#include "shade/brdf/plastic.h"
#include "shade/brdf/preset.h"
#include "shade/brdf/preset_names.h"
#include "shade/brdf/translucent.h"
#include "shade/camera/sampling.h"
#include "shade/data_folder.h"
#include "shade/finish/glitter.h"
#include "shade/finish/line_gloss.h"
#include "shade/finish/matte.h"
#include "shade/finish/silk.h"
#include "shade/measured/brdf_file.h"
#include "shade/palette/filament_color.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

namespace stratum::shade {

namespace {

/// The tables that come with the project.
std::filesystem::path tableFolder() { return dataFolder() / "brdf"; }

constexpr std::string_view kEnding = ".bsdf.gz";

std::vector<std::string> namesIn(const std::filesystem::path& folder) {
    std::vector<std::string> names;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
        const std::string name = entry.path().filename().string();
        if (name.ends_with(kEnding)) names.push_back(name.substr(0, name.size() - kEnding.size()));
    }
    std::sort(names.begin(), names.end());
    return names;
}

/// The table of that name, or an empty path.
std::filesystem::path tableNamed(std::string_view text) {
    if (text.empty() || text.find_first_of(":/.") != std::string_view::npos) return {};
    std::error_code error;
    std::filesystem::path path = tableFolder() / (std::string(text) + std::string(kEnding));
    return std::filesystem::is_regular_file(path, error) ? path : std::filesystem::path();
}

std::shared_ptr<const Brdf> readNamed(std::string_view text) {
    if (const std::filesystem::path table = tableNamed(text); !table.empty()) return readBrdfFile(table);
    std::error_code error;
    if (!text.empty() && std::filesystem::is_regular_file(std::filesystem::path(text), error))
        return readBrdfFile(text);
    if (const auto color = parseNamedColor(text)) return std::make_shared<Plastic>(bodyOf(*color), kFilamentAlpha);
    const bool none = namesIn(tableFolder()).empty();
    const std::vector<std::string> known = brdfNames();
    std::vector<std::string_view> names(known.begin(), known.end());
    names.insert(names.end(), {"lambert", "plastic", "fdm", "metal", "matte", "silk", "glitter", "translucent"});
    throw UsageError(fmt::format(
        "--brdf {}: is neither a file nor a material; write lambert:R,G,B, plastic:R,G,B,ALPHA, fdm:R,G,B,ALPHA, "
        "metal:R,G,B,ALPHA, matte:R,G,B, silk:R,G,B, glitter:R,G,B[,FLAKE_MM], "
        "translucent:R,G,B,MEAN_FREE_PATH_MM, a colour (#ff6600, teal), a file, or one of: {}{}{}",
        text, fmt::join(known, ", "), none ? fmt::format(" ({} has no tables)", tableFolder().string()) : "",
        didYouMean(text.substr(0, text.find(':')), names)));
}

bool isFormula(std::string_view text) {
    const std::string_view name = text.substr(0, text.find(':'));
    return name == "lambert" || name == "plastic" || name == "fdm" || name == "metal" || name == "matte" ||
           name == "silk" || name == "glitter" || isTranslucent(text);
}

}  // namespace

std::vector<std::string> brdfNames() {
    std::vector<std::string> names = namesIn(tableFolder());
    for (std::string& name : translucentNames()) names.push_back(std::move(name));
    std::sort(names.begin(), names.end());
    return names;
}

bool isBrdfPreset(std::string_view text) { return isFormula(text) || !tableNamed(text).empty(); }

void Brdf::evalStream(std::span<const glm::vec3> wo, std::span<const glm::vec3> wi, std::span<Color> values,
                      std::span<float> densities) const {
    for (std::size_t n = 0; n < wo.size(); ++n) {
        values[n] = eval(wo[n], wi[n]);
        densities[n] = pdf(wo[n], wi[n]);
    }
}

void Brdf::sampleStream(std::span<const glm::vec3> wo, std::span<const float> lobes, std::span<const glm::vec2> u,
                        std::span<BrdfSample> samples) const {
    for (std::size_t n = 0; n < wo.size(); ++n) samples[n] = sample(wo[n], lobes[n], u[n]).value_or(BrdfSample());
}

const std::vector<std::string>& Brdf::notes() const {
    static const std::vector<std::string> none;
    return none;
}

Color reflectanceFactor(const Brdf& brdf) {
    const float s = std::sqrt(0.5f);
    return kPi * brdf.eval({0.0f, 0.0f, 1.0f}, {s, 0.0f, s});
}

const char* const kDefaultBrdf = "plastic:0.82,0.21,0.03,0.22";

std::shared_ptr<const Brdf> makeBrdf(std::string_view text) {
    constexpr std::string_view kOption = "--brdf";
    if (text.empty()) text = kDefaultBrdf;
    if (isTranslucent(text)) return makeTranslucent(text, kOption);
    if (!isFormula(text)) return readNamed(text);
    const Preset preset = parsePreset(text, kOption);
    const auto bodyColor = [&] {
        for (std::size_t i = 0; i < 3; ++i) requireRange(preset, i, 0.0f, 1.0f, kOption, "a reflectance");
        return Color(preset.values[0], preset.values[1], preset.values[2]);
    };
    if (preset.name == "lambert") {
        requireValues(preset, 3, kOption, "lambert:R,G,B");
        return std::make_shared<Lambert>(bodyColor());
    }
    if (preset.name == "matte" || preset.name == "silk") {
        requireValues(preset, 3, kOption, preset.name + ":R,G,B");
        if (preset.name == "silk") return std::make_shared<Silk>(bodyColor());
        return std::make_shared<Matte>(bodyColor());
    }
    if (preset.name == "glitter") {
        if (preset.values.size() != 4) requireValues(preset, 3, kOption, "glitter:R,G,B or glitter:R,G,B,FLAKE_MM");
        if (preset.values.size() == 3) return std::make_shared<Glitter>(bodyColor());
        requireRange(preset, 3, Glitter::kMinSize, Glitter::kMaxSize, kOption, "the size of flakes in mm");
        return std::make_shared<Glitter>(bodyColor(), static_cast<double>(preset.values[3]));
    }
    if (preset.name == "fdm") {
        if (preset.values.size() != 5) requireValues(preset, 4, kOption, "fdm:R,G,B,ALPHA or fdm:R,G,B,ALPHA,RATIO");
        requireRange(preset, 3, Plastic::kMinAlpha, 1.0f, kOption, "ALPHA (GGX)");
        if (preset.values.size() == 4) return std::make_shared<Plastic>(plasticOfLines(bodyColor(), preset.values[3]));
        requireRange(preset, 4, 1.0f, kMostLineRatio, kOption, "RATIO, of alpha across the line to along it,");
        return std::make_shared<Plastic>(plasticOfLines(bodyColor(), preset.values[3], preset.values[4]));
    }
    const bool metal = preset.name == "metal";
    requireValues(preset, 4, kOption, metal ? "metal:R,G,B,ALPHA" : "plastic:R,G,B,ALPHA");
    requireRange(preset, 3, Plastic::kMinAlpha, 1.0f, kOption, "ALPHA (GGX)");
    if (metal) return std::make_shared<Metal>(bodyColor(), preset.values[3]);
    return std::make_shared<Plastic>(bodyColor(), preset.values[3]);
}

}  // namespace stratum::shade
