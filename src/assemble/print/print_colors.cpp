#include "assemble/print/print_colors.h"

#include "gcode/slicer/bead_colors.h"
#include "shade/palette/filament_color.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <optional>

namespace stratum::assemble {
namespace {

void add(PrintColors& colors, const std::string& hex, const std::string& from) {
    colors.stated.push_back(hex);
    colors.report.push_back({{"color", hex}, {"from", from}});
}

}  // namespace

PrintColors colorsOf(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection) {
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
        const gcode::Rgb& c = *stated.color;
        add(colors, fmt::format("#{:02x}{:02x}{:02x}", c[0], c[1], c[2]),
            fmt::format("{}, tool {}",
                        stated.palette   ? "a palette, for the file states none"
                        : stated.changed ? "a change of colour"
                                         : "the file's settings",
                        stated.tool));
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
