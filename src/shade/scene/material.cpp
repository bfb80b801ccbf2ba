#include "shade/scene/material.h"

#include "base/category_colors.h"
#include "base/error.h"
#include "base/text.h"
#include "shade/finish/named_brdf.h"
#include "shade/palette/filament_color.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/exponential.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>
#include <utility>

namespace stratum::shade {
namespace {

constexpr double kMostCategories = 32;
constexpr std::size_t kRampSteps = 256;
constexpr float kMostNumber = 2147483520.0f;  // the largest that fits into an int
constexpr float kBrightest = 0.95f;           // no filament reflects everything
const Color kNeutral(0.18f);                  // of values that are no numbers

/// Similar to the usual colors of slicers.
constexpr std::string_view kFeatureColors =
    "perimeter#e8cf3d external-perimeter#e87a2c overhang-perimeter#3a48d6 infill#a83232 solid-infill#8c52c4 "
    "top-infill#e04848 bridge#4a80c0 gap-fill#e8e8e8 ironing#e89070 skirt#0a8a70 brim#0a8a70 support#40b840 "
    "support-interface#1e7a1e wipe-tower#a8d8a0";

/// The number of a key of `each`: itself, or the index of a name.
int valueOf(const std::string& key, const MaterialOptions& options, const trace::AttributeSummary& summary) {
    if (const auto value = parsed<int>(key)) return *value;
    const auto found = std::find(summary.labels.begin(), summary.labels.end(), key);
    if (found == summary.labels.end()) {
        std::string known;
        for (const std::string& label : summary.labels)
            if (!label.empty()) known += (known.empty() ? "" : ", ") + label;
        throw UsageError(fmt::format("the material of {} '{}': that is neither a whole number nor one of its names: {}",
                                     options.by, key, known.empty() ? "the file has none" : known));
    }
    return static_cast<int>(found - summary.labels.begin());
}

/// The default color of a whole number: fixed colors for features, a palette for others.
Color colorOfInteger(int value, const trace::AttributeSummary& summary) {
    const auto id = static_cast<std::size_t>(value);
    if (id < summary.labels.size())
        for (const std::string_view named : split(kFeatureColors, ' '))
            if (named.substr(0, named.find('#')) == summary.labels[id])
                return *parseNamedColor(named.substr(named.find('#')));
    return categoryColor(id);
}

/// Whether each whole number has a color of its own instead of a position on a ramp.
bool isPalette(const MaterialOptions& options, const trace::AttributeSummary& summary) {
    return summary.kind == trace::AttributeSummary::Kind::integer && options.by != "layer" &&
           summary.most - summary.least < kMostCategories;
}

std::string nameOf(int value, const MaterialOptions& options, const trace::AttributeSummary& summary) {
    const auto id = static_cast<std::size_t>(value);
    if (id < summary.labels.size() && !summary.labels[id].empty()) return summary.labels[id];
    return fmt::format("{} {}", options.by, value);
}

std::shared_ptr<const Brdf> recolored(const Brdf& base, const Color& color, const std::string& text) {
    const Color body = glm::clamp(color, Color(0.0f), Color(kBrightest));
    if (auto brdf = base.recolored(body)) return brdf;
    throw UsageError(fmt::format(
        "the material {} has a colour of its own; to colour by an attribute take lambert:... or plastic:...", text));
}

// Of colors at even places from 0 to 1.
Color between(std::span<const std::uint32_t> stops, double t) {
    const double place = std::clamp(t, 0.0, 1.0) * static_cast<double>(stops.size() - 1);
    const auto n = std::min(static_cast<std::size_t>(place), stops.size() - 2);
    const auto w = static_cast<float>(place - static_cast<double>(n));
    // Interpolated between square roots, which is approximately perceptually uniform.
    const Color mixed = (1.0f - w) * glm::sqrt(fromSrgb(stops[n])) + w * glm::sqrt(fromSrgb(stops[n + 1]));
    return mixed * mixed;
}

// The values at the ends of a ramp.
std::array<double, 2> endsOf(const MaterialOptions& options, const trace::AttributeSummary& summary) {
    return options.range.value_or(std::array{summary.least, summary.most});
}

// A place of the ramp between two values.
Color rampOf(const std::array<double, 2>& ends, std::size_t n) {
    const double t = static_cast<double>(n) / (kRampSteps - 1);
    return ends[1] > 0 && ends[0] == -ends[1] ? divergingColor(t) : rampColor(t);
}

}  // namespace

ObjectMaterial::ObjectMaterial(std::shared_ptr<const Brdf> brdf) {
    const Color albedo = reflectanceFactor(*brdf);
    const bool by_place = brdf->variesByPlace();
    const Brdf* const undirected = brdf->undirected();
    materials_.push_back({std::move(brdf), albedo, by_place, undirected});
}

ObjectMaterial::ObjectMaterial(std::size_t attribute, const std::vector<std::shared_ptr<const Brdf>>& brdfs,
                               std::function<std::size_t(const glm::vec3&)> choose, bool filaments)
    : attribute_(attribute), choose_(std::move(choose)), filaments_(filaments) {
    for (const auto& brdf : brdfs)
        materials_.push_back({brdf, reflectanceFactor(*brdf), brdf->variesByPlace(), brdf->undirected()});
}

Color categoryColor(std::size_t n) { return fromSrgb(kCategoryColors[n % kCategoryColors.size()]); }

Color rampColor(double t) {
    constexpr std::array<std::uint32_t, 6> kStops = {0x2a1a5e, 0x2b5a92, 0x1f8f8c, 0x4fb562, 0xb5cf3f, 0xf7e65a};
    return between(kStops, t);
}

Color divergingColor(double t) {
    constexpr std::array<std::uint32_t, 5> kStops = {0x1d4e9e, 0x7fb0dd, 0xf2f0ec, 0xe8956f, 0xa51c24};
    return between(kStops, t);
}

bool ObjectMaterial::anyTranslucent() const {
    return std::any_of(materials_.begin(), materials_.end(),
                       [](const Material& material) { return material.brdf->translucent() != nullptr; });
}

bool ObjectMaterial::anyByPlace() const {
    return std::any_of(materials_.begin(), materials_.end(),
                       [](const Material& material) { return material.by_place; });
}

ObjectMaterial makeObjectMaterial(const MaterialOptions& options, const std::string& scene_brdf, std::size_t attribute,
                                  const trace::AttributeSummary& summary) {
    using Kind = trace::AttributeSummary::Kind;
    const std::string& text = options.brdf.empty() ? scene_brdf : options.brdf;
    const std::shared_ptr<const Brdf> base = makeBrdf(text);
    std::vector<std::shared_ptr<const Brdf>> brdfs{base};
    if (!options.each.empty() && summary.kind != Kind::color) {
        if (summary.kind != Kind::integer)
            throw UsageError(
                fmt::format("materials by {}: it holds no whole numbers; take tool, feature, layer or "
                            "object, or color_by",
                            options.by));
        std::map<int, std::size_t> place;
        for (const auto& [key, brdf] : options.each) {
            place[valueOf(key, options, summary)] = brdfs.size();
            brdfs.push_back(makeBrdf(brdf));
        }
        brdfs.push_back(base);
        return {attribute, brdfs, [place](const glm::vec3& v) {
                    const auto found = place.find(static_cast<int>(std::clamp(v.x, -kMostNumber, kMostNumber)));
                    return found == place.end() ? std::size_t{0} : found->second;
                }};
    }
    if (summary.kind == Kind::color) {
        for (const auto& [key, brdf] : options.each)
            if (!parseNamedColor(key))
                throw UsageError(
                    fmt::format("the material of {} '{}': that is no colour; write '#rrggbb'", options.by, key));
        for (const glm::vec3& color : summary.colors) {
            const auto given = options.each.find(hexOf(color));
            brdfs.push_back(color == trace::kNoColor      ? base
                            : given != options.each.end() ? std::shared_ptr<const Brdf>(makeBrdf(given->second))
                                                          : recolored(*base, bodyOf(color), text));
        }
        brdfs.push_back(recolored(*base, kNeutral, text));
        const auto choose = [colors = summary.colors](const glm::vec3& v) {
            const auto found = std::lower_bound(colors.begin(), colors.end(), v, trace::Before());
            return found != colors.end() && *found == v ? static_cast<std::size_t>(found - colors.begin()) + 1
                                                        : std::size_t{0};
        };
        return {attribute, brdfs, choose, true};
    }
    const double least = summary.least;
    const double span = summary.most - least;
    if (isPalette(options, summary)) {
        for (int n = 0; n <= static_cast<int>(span); ++n)
            brdfs.push_back(recolored(*base, colorOfInteger(static_cast<int>(least) + n, summary), text));
        brdfs.push_back(recolored(*base, kNeutral, text));
        return {attribute, brdfs, [least, span](const glm::vec3& v) {
                    const double n = static_cast<double>(v.x) - least;
                    return n >= 0 && n <= span ? static_cast<std::size_t>(n) + 1 : std::size_t{0};
                }};
    }
    const std::array<double, 2> ends = endsOf(options, summary);
    for (std::size_t n = 0; n < kRampSteps; ++n) brdfs.push_back(recolored(*base, rampOf(ends, n), text));
    brdfs.push_back(recolored(*base, kNeutral, text));
    return {attribute, brdfs, [low = ends[0], wide = ends[1] - ends[0]](const glm::vec3& v) {
                const double t = wide > 0 ? (static_cast<double>(v.x) - low) / wide : 0.0;
                return 1 + static_cast<std::size_t>(std::lround(std::clamp(t, 0.0, 1.0) * (kRampSteps - 1)));
            }};
}

Legend makeLegend(const MaterialOptions& options, const trace::AttributeSummary& summary,
                  const ObjectMaterial& material) {
    using Kind = trace::AttributeSummary::Kind;
    Legend legend;
    legend.title = options.by;
    if (!options.each.empty() && summary.kind != Kind::color) {
        for (const auto& [key, text] : options.each) {
            const int value = valueOf(key, options, summary);
            legend.entries.push_back({nameOf(value, options, summary),
                                      material.of(glm::vec3(static_cast<float>(value), 0.0f, 0.0f)).albedo});
        }
    } else if (summary.kind == Kind::color) {
        for (const glm::vec3& color : summary.colors)
            legend.entries.push_back({color == trace::kNoColor ? "not stated" : hexOf(color), color});
    } else if (isPalette(options, summary)) {
        for (const int value : summary.values)
            legend.entries.push_back({nameOf(value, options, summary), colorOfInteger(value, summary)});
    } else {
        const std::array<double, 2> ends = endsOf(options, summary);
        legend.least = ends[0];
        legend.most = ends[1];
        for (std::size_t n = 0; n < kRampSteps; ++n) legend.ramp.push_back(rampOf(ends, n));
    }
    return legend;
}

}  // namespace stratum::shade
