#include "python/make_toolpath.h"

#include "base/error.h"
#include "gcode/text/limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

namespace stratum::python {

namespace {

constexpr float kMostMillimetres = 100;  // of a bead's width or height

void requireRun(const gcode::Toolpath& toolpath, std::size_t n) {
    const gcode::Run& run = toolpath.runs[n];
    if (!(run.height > 0 && run.height <= kMostMillimetres))
        throw UsageError(fmt::format("runs[{}]: height {:g}: expected millimetres above 0, at most {:g}", n, run.height,
                                     kMostMillimetres));
    if (!std::isfinite(run.speed) || run.speed < 0)
        throw UsageError(fmt::format("runs[{}]: speed {:g}: expected mm/s, or 0 if it is not known", n, run.speed));
    if (run.object >= toolpath.objects.size())
        throw UsageError(fmt::format("runs[{}]: object {}: there are {}; give their names as objects, [0] is \"\"", n,
                                     run.object, toolpath.objects.size()));
    constexpr std::uint32_t kMostLayers = 1000000;
    if (run.layer > kMostLayers)
        throw UsageError(fmt::format("runs[{}]: layer {}: expected at most {}", n, run.layer, kMostLayers));
    if (static_cast<std::size_t>(run.feature) >= gcode::kFeatureCount)
        throw UsageError(fmt::format("runs[{}]: feature {}: expected an index into stratum.features, below {}", n,
                                     static_cast<int>(run.feature), gcode::kFeatureCount));
}

void requireArc(const gcode::Toolpath& toolpath, std::size_t n) {
    const gcode::Arc& arc = toolpath.arcs[n];
    if (!(std::abs(arc.center_x) <= gcode::kMaxCoordinate && std::abs(arc.center_y) <= gcode::kMaxCoordinate))
        throw UsageError(fmt::format("arcs[{}]: center ({:g}, {:g}): expected millimetres within {:g}", n, arc.center_x,
                                     arc.center_y, gcode::kMaxCoordinate));
    if (!(std::abs(arc.sweep) <= 2 * std::numbers::pi * (1 + 1e-12)) || arc.sweep == 0)
        throw UsageError(
            fmt::format("arcs[{}]: sweep {:g}: expected radians, not 0, at most a full turn", n, arc.sweep));
}

void requireBead(const gcode::Toolpath& toolpath, std::size_t n) {
    const gcode::Bead& bead = toolpath.beads[n];
    constexpr std::array<const char*, 6> kNames = {"x0", "y0", "z0", "x1", "y1", "z1"};
    const std::array<double, 6> values = {bead.x0, bead.y0, bead.z0, bead.x1, bead.y1, bead.z1};
    for (std::size_t k = 0; k < values.size(); ++k)
        if (!(std::abs(values[k]) <= gcode::kMaxCoordinate))
            throw UsageError(
                fmt::format("beads[{}]: {} is {:g}: expected a finite number of millimetres, within {:g}; "
                            "leave such beads out",
                            n, kNames[k], values[k], gcode::kMaxCoordinate));
    if (!(bead.width > 0 && bead.width <= kMostMillimetres))
        throw UsageError(fmt::format("beads[{}]: width {:g}: expected millimetres above 0, at most {:g}", n, bead.width,
                                     kMostMillimetres));
    if (bead.run >= toolpath.runs.size())
        throw UsageError(fmt::format("beads[{}]: run {}: there are {}; it is an index into runs", n, bead.run,
                                     toolpath.runs.size()));
    if (bead.arc >= 0 && static_cast<std::size_t>(bead.arc) >= toolpath.arcs.size())
        throw UsageError(fmt::format("beads[{}]: arc {}: there are {}; it is an index into arcs, or -1 if straight", n,
                                     bead.arc, toolpath.arcs.size()));
    if (bead.arc < 0) return;
    const gcode::Arc& arc = toolpath.arcs[static_cast<std::size_t>(bead.arc)];
    const double radius = std::hypot(bead.x0 - arc.center_x, bead.y0 - arc.center_y);
    const double other = std::hypot(bead.x1 - arc.center_x, bead.y1 - arc.center_y);
    if (!(radius > 0 && other > 0) || std::abs(radius - other) > 0.01 * std::max(radius, other) + 0.01)
        throw UsageError(
            fmt::format("beads[{}]: its ends are {:g} and {:g} mm from the center of arcs[{}]; the same "
                        "radius was expected",
                        n, radius, other, bead.arc));
    const double c = std::cos(arc.sweep), s = std::sin(arc.sweep);
    const double x = bead.x0 - arc.center_x, y = bead.y0 - arc.center_y;
    const double miss = std::hypot(arc.center_x + c * x - s * y - bead.x1, arc.center_y + s * x + c * y - bead.y1);
    if (miss > 0.02 * std::max(radius, other) + 0.02)
        throw UsageError(
            fmt::format("beads[{}]: the sweep of arcs[{}], {:g} radians, ends {:g} mm beside the bead's end", n,
                        bead.arc, arc.sweep, miss));
}

}  // namespace

void requireValid(const gcode::Toolpath& toolpath) {
    if (toolpath.beads.empty()) throw UsageError("beads: is empty; a toolpath has one bead at least");
    if (toolpath.beads.size() > std::numeric_limits<std::uint32_t>::max() - 1)
        throw UsageError("beads: more than 2^32 - 2; divide them");
    if (toolpath.objects.empty() || !toolpath.objects.front().empty())
        throw UsageError("objects: the first must be \"\", of beads without an object");
    if (toolpath.objects.size() > std::numeric_limits<std::uint16_t>::max())
        throw UsageError("objects: more than 65535; join some");
    for (std::size_t n = 0; n < toolpath.runs.size(); ++n) requireRun(toolpath, n);
    for (std::size_t n = 0; n < toolpath.arcs.size(); ++n) requireArc(toolpath, n);
    for (std::size_t n = 0; n < toolpath.beads.size(); ++n) requireBead(toolpath, n);
}

namespace {

std::vector<double> volumesByTool(const gcode::Toolpath& toolpath) {
    std::vector<double> volumes;
    for (std::uint32_t n = 0; n < toolpath.beads.size(); ++n) {
        const std::size_t tool = toolpath.runOf(toolpath.beads[n]).tool;
        if (volumes.size() <= tool) volumes.resize(tool + 1);
        volumes[tool] += gcode::laidVolume(toolpath, n);
    }
    return volumes;
}

}  // namespace

void sumUp(gcode::Toolpath& toolpath, const gcode::Toolpath* before) {
    toolpath.layer_count = 0;
    for (const gcode::Run& run : toolpath.runs) toolpath.layer_count = std::max(toolpath.layer_count, run.layer);
    toolpath.extruded_mm3 = gcode::beadVolume(toolpath);
    const double area = 0.25 * std::numbers::pi * toolpath.filament_diameter * toolpath.filament_diameter;
    const std::vector<double> volumes = volumesByTool(toolpath);
    const std::vector<double> known = before != nullptr ? volumesByTool(*before) : std::vector<double>();
    toolpath.filament_by_tool.assign(volumes.size(), 0.0);
    for (std::size_t tool = 0; tool < volumes.size(); ++tool) {
        // Each tool's filament may have a thickness of its own.
        const bool scales = tool < known.size() && known[tool] > 0 && tool < before->filament_by_tool.size();
        toolpath.filament_by_tool[tool] =
            scales ? before->filament_by_tool[tool] * volumes[tool] / known[tool] : volumes[tool] / area;
    }
    toolpath.filament_mm = std::accumulate(toolpath.filament_by_tool.begin(), toolpath.filament_by_tool.end(), 0.0);
}

}  // namespace stratum::python
