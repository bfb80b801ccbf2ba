// Toolpaths made by hand.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

namespace stratum::study {

/// Adds a bead, mm; a new run is made for each height.
inline void addBead(gcode::Toolpath& toolpath, double x0, double y0, double z0, double x1, double y1, double z1,
                    double width, double height, std::uint32_t layer = 1) {
    gcode::Run run;
    run.height = static_cast<float>(height);
    run.layer = layer;
    if (toolpath.runs.empty() || !(toolpath.runs.back() == run)) toolpath.runs.push_back(run);
    gcode::Bead bead;
    bead.x0 = x0, bead.y0 = y0, bead.z0 = z0;
    bead.x1 = x1, bead.y1 = y1, bead.z1 = z1;
    bead.width = static_cast<float>(width);
    bead.run = static_cast<std::uint32_t>(toolpath.runs.size() - 1);
    toolpath.beads.push_back(bead);
    toolpath.layer_count = std::max(toolpath.layer_count, layer);
}

/// Adds a circular bead about (cx, cy) from angle `from` (radians), turning by `sweep`.
inline void addArc(gcode::Toolpath& toolpath, double cx, double cy, double radius, double from, double sweep, double z0,
                   double z1, double width, double height, std::uint32_t layer = 1) {
    addBead(toolpath, cx + radius * std::cos(from), cy + radius * std::sin(from), z0,
            cx + radius * std::cos(from + sweep), cy + radius * std::sin(from + sweep), z1, width, height, layer);
    toolpath.beads.back().arc = static_cast<std::int32_t>(toolpath.arcs.size());
    toolpath.arcs.push_back({cx, cy, sweep});
}

inline std::vector<std::uint32_t> allBeads(const gcode::Toolpath& toolpath) {
    std::vector<std::uint32_t> beads(toolpath.beads.size());
    std::iota(beads.begin(), beads.end(), 0U);
    return beads;
}

/// Three layers of two crossing lines, with their middle at (x, y), from z up.
inline gcode::Toolpath crossedLines(double width, double height, double x = 0, double y = 0, double z = 0) {
    gcode::Toolpath toolpath;
    for (int layer = 0; layer < 3; ++layer) {
        const double top = z + height * (layer + 1);
        const auto number = static_cast<std::uint32_t>(layer + 1);
        addBead(toolpath, x - 2 * width, y, top, x + 2 * width, y + width / 3, top, width, height, number);
        addBead(toolpath, x, y - 2 * width, top, x + width / 5, y + 2 * width, top, width, height, number);
    }
    return toolpath;
}

}  // namespace stratum::study
