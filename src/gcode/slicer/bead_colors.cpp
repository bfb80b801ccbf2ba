#include "gcode/slicer/bead_colors.h"

#include "base/category_colors.h"

#include <algorithm>
#include <utility>

namespace stratum::gcode {

namespace {

Rgb paletteColor(std::size_t n) {
    const std::uint32_t color = kCategoryColors[n % kCategoryColors.size()];
    return {static_cast<std::uint8_t>(color >> 16U), static_cast<std::uint8_t>(color >> 8U),
            static_cast<std::uint8_t>(color)};
}

}  // namespace

void colorUnstated(Toolpath& toolpath) {
    const std::vector<double>& filament = toolpath.filament_by_tool;
    const auto changes = std::count_if(
        toolpath.color_changes.begin(), toolpath.color_changes.end(),
        [&](const ColorChange& change) { return !change.stated && change.first_bead < toolpath.beads.size(); });
    const auto tools = std::count_if(filament.begin(), filament.end(), [](double mm) { return mm > 0; });
    if (tools + changes < 2) return;
    if (toolpath.tool_colors.size() < filament.size()) toolpath.tool_colors.resize(filament.size());
    for (std::size_t tool = 0; tool < filament.size(); ++tool) {
        if (!(filament[tool] > 0) || toolpath.tool_colors[tool]) continue;
        toolpath.tool_colors[tool] = paletteColor(tool);
        toolpath.palette_tools.push_back(static_cast<std::uint8_t>(tool));
    }
    std::size_t next = filament.size();
    for (ColorChange& change : toolpath.color_changes)
        if (!change.stated) change.color = paletteColor(next++);
}

StatedColor statedColorOf(const Toolpath& toolpath, std::size_t bead) {
    const std::uint8_t tool = toolpath.runOf(toolpath.beads[bead]).tool;
    const std::vector<std::uint8_t>& palette = toolpath.palette_tools;
    StatedColor stated{std::nullopt, tool, false, std::find(palette.begin(), palette.end(), tool) != palette.end()};
    if (tool < toolpath.tool_colors.size()) stated.color = toolpath.tool_colors[tool];
    for (const ColorChange& change : toolpath.color_changes) {
        if (change.first_bead > bead) break;
        if (change.tool == tool) stated = {change.color, tool, true, !change.stated};
    }
    return stated;
}

std::vector<StatedColor> statedColors(const Toolpath& toolpath, std::span<const std::uint32_t> selection) {
    std::vector<StatedColor> colors;
    const auto& changes = toolpath.color_changes;
    std::optional<std::pair<std::uint32_t, std::ptrdiff_t>> last;
    for (const std::uint32_t bead : selection) {
        // Within a run only a change of filament makes a difference.
        const auto done = std::upper_bound(changes.begin(), changes.end(), bead,
                                           [](std::uint32_t b, const ColorChange& c) { return b < c.first_bead; });
        const std::pair here(toolpath.beads[bead].run, done - changes.begin());
        if (std::exchange(last, here) == here) continue;
        const StatedColor stated = statedColorOf(toolpath, bead);
        if (std::none_of(colors.begin(), colors.end(),
                         [&stated](const StatedColor& known) { return known.color == stated.color; }))
            colors.push_back(stated);
    }
    return colors;
}

std::optional<Rgb> colorOf(const Toolpath& toolpath, std::size_t bead) { return statedColorOf(toolpath, bead).color; }

std::vector<std::optional<Rgb>> distinctColors(const Toolpath& toolpath, std::span<const std::uint32_t> selection) {
    std::vector<std::optional<Rgb>> colors;
    for (const StatedColor& stated : statedColors(toolpath, selection)) colors.push_back(stated.color);
    return colors;
}

}  // namespace stratum::gcode
