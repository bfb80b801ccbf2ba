#include "assemble/print/print_colors.h"

#include "base/error.h"
#include "base/text.h"
#include "gcode/slicer/bead_colors.h"
#include "shade/palette/color_name.h"
#include "shade/palette/filament_color.h"
#include "shade/palette/finish_words.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace stratum::assemble {

ToolColors toolColorsOf(std::string_view list, std::string_view option) {
    constexpr std::size_t kMostTools = 256;
    ToolColors result;
    for (const std::string_view piece : split(list)) {
        const std::string_view name = trim(piece);
        if (result.colors.size() == kMostTools)
            throw UsageError(fmt::format("{}: more than {} colours; there are no more tools", option, kMostTools));
        if (name.empty()) {
            result.colors.emplace_back();
            continue;
        }
        const shade::ColorName color = shade::colorNamed(name, option);
        result.colors.push_back(gcode::Rgb{static_cast<std::uint8_t>(color.color >> 16),
                                           static_cast<std::uint8_t>(color.color >> 8 & 0xff),
                                           static_cast<std::uint8_t>(color.color & 0xff)});
        if (color.brdf.find(':') != std::string::npos)
            result.finishes.emplace(fmt::format("#{:06x}", color.color), color.brdf);
    }
    return result;
}

namespace {

void add(PrintColors& colors, const std::string& hex, const std::string& from) {
    colors.stated.push_back(hex);
    colors.report.push_back({{"color", hex}, {"from", from}});
}

// The finish of the last color, by the words of its filament.
void addFinish(PrintColors& colors, const gcode::StatedFacts& facts, std::size_t tool) {
    for (const std::vector<std::string>* const names : {&facts.profiles, &facts.materials}) {
        if (tool >= names->size()) continue;
        const shade::Finish finish = shade::finishOfProfile((*names)[tool]);
        if (finish == shade::Finish::plain) continue;
        const std::string& hex = colors.stated.back();
        const auto color = static_cast<std::uint32_t>(std::stoul(hex.substr(1), nullptr, 16));
        colors.finishes.emplace(hex, shade::brdfOf(color, finish));
        colors.report.back()["finish"] = shade::finishName(finish);
        colors.report.back()["finish_from"] = (*names)[tool];
        return;
    }
}

}  // namespace

PrintColors colorsOf(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                     std::span<const std::optional<gcode::Rgb>> asked) {
    PrintColors colors;
    if (std::none_of(toolpath.tool_colors.begin(), toolpath.tool_colors.end(),
                     [](const std::optional<gcode::Rgb>& color) { return color.has_value(); }) &&
        toolpath.color_changes.empty())
        return colors;
    for (const gcode::StatedColor& stated : gcode::statedColors(toolpath, selection)) {
        if (!stated.color) {
            colors.some_unstated = true;
            continue;
        }
        add(colors, gcode::colorText(*stated.color),
            fmt::format("{}, tool {}",
                        stated.palette   ? "a palette, for the file states none"
                        : stated.changed ? "a change of colour"
                                         : "the file's settings",
                        stated.tool));
        const bool own = stated.tool < asked.size() && asked[stated.tool];
        if (!own && !stated.changed) addFinish(colors, toolpath.stated, stated.tool);
    }
    colors.by_place = colors.stated.size() + (colors.some_unstated ? 1 : 0) > 1 && !colors.stated.empty();
    return colors;
}

PrintColors colorsOf(const std::string& path, const openvdb::FloatGrid& head) {
    PrintColors colors;
    if (march::hasGrid(path, "color")) {
        colors.by_place = true;
        return colors;
    }
    const auto text = head.getMetadata<openvdb::StringMetadata>("filament_color");
    if (!text) return colors;
    // Other programs may write it, too: a text that is no color is ignored.
    if (const auto color = shade::parseNamedColor(text->value()))
        add(colors, shade::hexOf(*color), "filament_color of the grid");
    return colors;
}

}  // namespace stratum::assemble
