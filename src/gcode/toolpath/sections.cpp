#include "gcode/toolpath/sections.h"

#include "gcode/toolpath/heights.h"
#include "gcode/toolpath/ramps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace stratum::gcode {
namespace {

constexpr double kMostHeights = 100;  // a bead wider than this many heights is a mistake
constexpr double kBlobHeights = 10;
constexpr double kBlobLengths = 4;

double widthOf(const Toolpath& toolpath, const Bead& bead, double area, double height, WarningLog& warnings) {
    const double width = sectionWidth(area, height);
    if (width <= kBlobHeights * height) return width;
    const double length = beadLength(toolpath, bead);
    if (width > kBlobLengths * length) {
        warnings.add("blob: far more material than a bead of this length holds; drawn as a disc of that volume",
                     toolpath.lineOf(bead));
        return std::min(2 * std::sqrt(area * length / (std::numbers::pi * height)), kMostHeights * height);
    }
    if (width > kMostHeights * height) {
        warnings.add("bead wider than 100 layer heights; cut to that", toolpath.lineOf(bead));
        return kMostHeights * height;
    }
    return width;
}

}  // namespace

void resolveHeights(Toolpath& toolpath, std::span<const double> run_z, std::optional<double> nominal_height,
                    WarningLog& warnings) {
    const bool all_tagged =
        std::all_of(toolpath.runs.begin(), toolpath.runs.end(), [](const Run& run) { return run.height > 0; });
    if (all_tagged) return;
    const std::vector<double> heights = findHeights(toolpath, run_z, nominal_height, warnings);
    for (std::size_t k = 0; k < heights.size(); ++k) toolpath.runs[k].height = static_cast<float>(heights[k]);
}

void resolveSections(Toolpath& toolpath, std::span<const double> run_z, std::optional<double> nominal_height,
                     WarningLog& warnings) {
    resolveHeights(toolpath, run_z, nominal_height, warnings);
    splitRamps(toolpath);
    for (Bead& bead : toolpath.beads) {
        const double height = static_cast<double>(toolpath.runOf(bead).height);
        bead.width = static_cast<float>(widthOf(toolpath, bead, static_cast<double>(bead.width), height, warnings));
    }
    if (!toolpath.cut_short.empty() && !toolpath.empty()) {
        const Bead& last = toolpath.beads.back();
        warnings.add(fmt::format("the program seems to be cut short ({}); its last layer is {}, at z = {:g} mm",
                                 toolpath.cut_short, toolpath.runOf(last).layer, double{last.z1}),
                     toolpath.lineOf(last));
    }
}

}  // namespace stratum::gcode
