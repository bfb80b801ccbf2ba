#include "gcode/slicer/bead_colors.h"

#include <algorithm>
#include <utility>

namespace stratum::gcode {

StatedColor statedColorOf(const Toolpath& toolpath, std::size_t bead) {
    const std::uint8_t tool = toolpath.runOf(toolpath.beads[bead]).tool;
    StatedColor stated{std::nullopt, tool, false};
    if (tool < toolpath.tool_colors.size()) stated.color = toolpath.tool_colors[tool];
    for (const ColorChange& change : toolpath.color_changes) {
        if (change.first_bead > bead) break;
        if (change.tool == tool) stated = {change.color, tool, true};
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
