#include "gcode/slicer/bead_colors.h"

#include <algorithm>

namespace stratum::gcode {

std::optional<Rgb> colorOf(const Toolpath& toolpath, std::size_t bead) {
    const std::uint8_t tool = toolpath.runOf(toolpath.beads[bead]).tool;
    std::optional<Rgb> color;
    if (tool < toolpath.tool_colors.size()) color = toolpath.tool_colors[tool];
    for (const ColorChange& change : toolpath.color_changes) {
        if (change.first_bead > bead) break;
        if (change.tool == tool) color = change.color;
    }
    return color;
}

std::vector<std::optional<Rgb>> distinctColors(const Toolpath& toolpath, std::span<const std::uint32_t> selection) {
    std::vector<std::optional<Rgb>> colors;
    for (const std::uint32_t bead : selection) {
        const std::optional<Rgb> color = colorOf(toolpath, bead);
        if (!colors.empty() && colors.back() == color) continue;  // neighbours mostly agree
        if (std::find(colors.begin(), colors.end(), color) == colors.end()) colors.push_back(color);
    }
    return colors;
}

}  // namespace stratum::gcode
