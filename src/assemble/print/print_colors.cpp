#include "assemble/print/print_colors.h"

#include "shade/brdf/filament_color.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <optional>

namespace stratum::assemble {
namespace {

using Rgb = std::array<std::uint8_t, 3>;

struct Stated {
    std::optional<Rgb> color;
    std::string from;
    bool operator==(const Stated& other) const { return color == other.color; }
};

Stated statedOf(const gcode::Toolpath& toolpath, std::uint32_t bead) {
    const std::uint8_t tool = toolpath.runOf(toolpath.beads[bead]).tool;
    Stated stated;
    if (tool < toolpath.tool_colors.size()) {
        stated.color = toolpath.tool_colors[tool];
        stated.from = fmt::format("the file's settings, tool {}", tool);
    }
    for (const gcode::ColorChange& change : toolpath.color_changes) {
        if (change.first_bead > bead) break;
        if (change.tool != tool) continue;
        stated.color = change.color;
        stated.from = fmt::format("a change of colour, tool {}", tool);
    }
    return stated;
}

void add(PrintColors& colors, const std::string& hex, const std::string& from) {
    colors.stated.push_back(hex);
    colors.report.push_back({{"color", hex}, {"from", from}});
}

}  // namespace

PrintColors colorsOf(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection) {
    PrintColors colors;
    if (std::none_of(toolpath.tool_colors.begin(), toolpath.tool_colors.end(),
                     [](const std::optional<Rgb>& color) { return color.has_value(); }) &&
        toolpath.color_changes.empty())
        return colors;
    std::vector<Stated> seen;
    std::uint32_t last_run = 0;
    bool any = false;
    std::size_t next_change = 0;
    for (const std::uint32_t bead : selection) {
        // Within a run only a change of colour makes a difference.
        const std::uint32_t run = toolpath.beads[bead].run;
        bool changed = !any || run != last_run;
        while (next_change < toolpath.color_changes.size() && toolpath.color_changes[next_change].first_bead <= bead) {
            ++next_change;
            changed = true;
        }
        if (!changed) continue;
        any = true;
        last_run = run;
        Stated stated = statedOf(toolpath, bead);
        if (std::find(seen.begin(), seen.end(), stated) == seen.end()) seen.push_back(std::move(stated));
    }
    for (const Stated& stated : seen) {
        if (!stated.color) {
            colors.some_unstated = true;
            continue;
        }
        const Rgb& c = *stated.color;
        add(colors, fmt::format("#{:02x}{:02x}{:02x}", c[0], c[1], c[2]), stated.from);
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
    // Written by others, too: what is no colour says nothing.
    if (const auto color = shade::parseNamedColor(text->value()))
        add(colors, shade::hexOf(*color), "filament_color of the grid");
    return colors;
}

}  // namespace stratum::assemble
