#include "shade/finish/named_brdf.h"

#include "base/error.h"
#include "base/names.h"
#include "shade/brdf/lambert.h"
#include "shade/brdf/plastic.h"
#include "shade/brdf/preset.h"
#include "shade/brdf/translucent.h"
#include "shade/data_folder.h"
#include "shade/finish/finishes.h"
#include "shade/finish/glitter.h"
#include "shade/finish/line_gloss.h"
#include "shade/measured/brdf_file.h"
#include "shade/palette/filament_color.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
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

constexpr std::string_view kOption = "--brdf";

float glossAlpha(const Preset& preset) {
    requireRange(preset, 3, Plastic::kMinAlpha, 1.0f, kOption, "ALPHA (GGX)");
    return preset.values[3];
}

/// A material by a formula: how it is written, and how it is made of the numbers, of which there are as many as the
/// form names; those in brackets may be left out.
struct Formula {
    BrdfForm form;
    std::shared_ptr<const Brdf> (*make)(const Preset&);
};

template <typename Material>
std::shared_ptr<const Brdf> ofColor(const Preset& preset) {
    return std::make_shared<Material>(bodyColor(preset, kOption));
}

template <typename Material>
std::shared_ptr<const Brdf> ofColorAndAlpha(const Preset& preset) {
    const Color color = bodyColor(preset, kOption);
    return std::make_shared<Material>(color, glossAlpha(preset));
}

std::shared_ptr<const Brdf> glitter(const Preset& preset) {
    if (preset.values.size() == 3) return ofColor<Glitter>(preset);
    requireRange(preset, 3, Glitter::kMinSize, Glitter::kMaxSize, kOption, "the size of flakes in mm");
    return std::make_shared<Glitter>(bodyColor(preset, kOption), static_cast<double>(preset.values[3]));
}

std::shared_ptr<const Brdf> plasticWithLines(const Preset& preset) {
    const float alpha = glossAlpha(preset);
    if (preset.values.size() == 4) return std::make_shared<Plastic>(plasticOfLines(bodyColor(preset, kOption), alpha));
    requireRange(preset, 4, 1.0f, kMostLineRatio, kOption, "RATIO, of alpha across the line to along it,");
    return std::make_shared<Plastic>(plasticOfLines(bodyColor(preset, kOption), alpha, preset.values[4]));
}

std::shared_ptr<const Brdf> translucent(const Preset& preset) { return makeTranslucent(preset, kOption); }

std::shared_ptr<const Brdf> byDistance(const Preset& preset) { return makeTranslucentByDistance(preset, kOption); }

constexpr std::array<Formula, 9> kFormulas{{
    {{"lambert:R,G,B", "ideally diffuse"}, ofColor<Lambert>},
    {{"plastic:R,G,B,ALPHA", "GGX alpha"}, ofColorAndAlpha<Plastic>},
    {{"fdm:R,G,B,ALPHA[,RATIO]", "gloss along lines"}, plasticWithLines},
    {{"metal:R,G,B,ALPHA", ""}, ofColorAndAlpha<Metal>},
    {{"matte:R,G,B", ""}, ofColor<Matte>},
    {{"silk:R,G,B", ""}, ofColor<Silk>},
    {{"glitter:R,G,B[,FLAKE_MM]", ""}, glitter},
    {{"translucent:R,G,B,MEAN_FREE_PATH_MM[,G]", "light goes through; also natural-pla, clear-petg, lithophane-white"},
     translucent},
    {{"td:R,G,B,TRANSMISSION_DISTANCE_MM", "the same by what meters of filament measure"}, byDistance},
}};

std::string_view nameOf(std::string_view text) { return text.substr(0, text.find(':')); }

/// Null if there is none of that name.
const Formula* formulaNamed(std::string_view name) {
    const auto found = std::find_if(kFormulas.begin(), kFormulas.end(),
                                    [name](const Formula& formula) { return nameOf(formula.form.form) == name; });
    return found == kFormulas.end() ? nullptr : &*found;
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
    std::string forms;
    for (const BrdfForm& form : brdfForms()) {
        names.push_back(nameOf(form.form));
        forms.append(form.form).append(", ");
    }
    throw UsageError(fmt::format(
        "--brdf {}: is neither a file nor a material; write {}a colour (#ff6600, teal), a file, or one of: {}{}{}",
        text, forms, fmt::join(known, ", "), none ? fmt::format(" ({} has no tables)", tableFolder().string()) : "",
        didYouMean(nameOf(text), names)));
}

bool isFormula(std::string_view text) { return formulaNamed(nameOf(text)) != nullptr || isTranslucent(text); }

}  // namespace

std::vector<std::string> brdfNames() {
    std::vector<std::string> names = namesIn(tableFolder());
    for (std::string& name : translucentNames()) names.push_back(std::move(name));
    std::sort(names.begin(), names.end());
    return names;
}

std::vector<BrdfForm> brdfForms() {
    std::vector<BrdfForm> forms;
    forms.reserve(kFormulas.size());
    for (const Formula& formula : kFormulas) forms.push_back(formula.form);
    return forms;
}

bool isBrdfPreset(std::string_view text) { return isFormula(text) || !tableNamed(text).empty(); }

const char* const kDefaultBrdf = "plastic:0.82,0.21,0.03,0.22";

std::shared_ptr<const Brdf> makeBrdf(std::string_view text) {
    if (text.empty()) text = kDefaultBrdf;
    const Formula* formula = formulaNamed(nameOf(text));
    if (formula == nullptr)
        return isTranslucent(text) ? makeTranslucent(parsePreset(text, kOption), kOption) : readNamed(text);
    const std::string_view form = formula->form.form;
    const Preset preset = parsePreset(text, kOption);
    const auto numbers = [](std::string_view part) {
        return part.empty() ? 0 : static_cast<std::size_t>(1 + std::count(part.begin(), part.end(), ','));
    };
    const std::string_view least = form.substr(0, form.find('['));
    if (preset.values.size() != numbers(form)) requireValues(preset, numbers(least), kOption, form);
    return formula->make(preset);
}

}  // namespace stratum::shade
