#include "gcode/toolpath/toolpath.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::gcode {
namespace {

constexpr std::array<std::string_view, kFeatureCount> kFeatureNames{
    "unknown",
    "perimeter",
    "external-perimeter",
    "overhang-perimeter",
    "infill",
    "solid-infill",
    "top-infill",
    "bridge",
    "gap-fill",
    "ironing",
    "skirt",
    "brim",
    "support",
    "support-interface",
    "wipe-tower",
    "custom",
};

}  // namespace

std::string_view featureName(Feature feature) {
    const auto i = static_cast<std::size_t>(feature);
    return i < kFeatureCount ? kFeatureNames[i] : "unknown";
}

Feature featureNamed(std::string_view name) {
    const auto found = std::find(kFeatureNames.begin(), kFeatureNames.end(), name);
    return static_cast<Feature>(found - kFeatureNames.begin());
}

double beadLength(const Toolpath& toolpath, const Bead& bead) {
    double plan = 0;
    if (bead.arc < 0) {
        plan = std::hypot(bead.x1 - bead.x0, bead.y1 - bead.y0);
    } else {
        const Arc& arc = toolpath.arcs[static_cast<std::size_t>(bead.arc)];
        const double radius = 0.5 * (std::hypot(bead.x0 - arc.center_x, bead.y0 - arc.center_y) +
                                     std::hypot(bead.x1 - arc.center_x, bead.y1 - arc.center_y));
        plan = radius * std::abs(arc.sweep);
    }
    const double rise = bead.z1 - bead.z0;
    return rise == 0 ? plan : std::hypot(plan, rise);
}

PathDirection pathDirection(const Toolpath& toolpath, const Bead& bead, double x, double y) {
    const double climb = bead.z1 - bead.z0;
    if (bead.arc < 0) return {bead.x1 - bead.x0, bead.y1 - bead.y0, climb};
    const Arc& arc = toolpath.arcs[static_cast<std::size_t>(bead.arc)];
    const double away_x = x - arc.center_x;
    const double away_y = y - arc.center_y;
    const double away = std::hypot(away_x, away_y);
    if (!(away > 0)) return {0, 0, climb};
    const double plan = arc.sweep * std::hypot(bead.x0 - arc.center_x, bead.y0 - arc.center_y);
    return {-away_y / away * plan, away_x / away * plan, climb};
}

double beadSeconds(const Toolpath& toolpath, const Bead& bead) {
    const double speed = toolpath.runOf(bead).speed;
    return speed > 0 ? beadLength(toolpath, bead) / speed : 0;
}

double meanWidth(const Toolpath& toolpath, std::span<const std::uint32_t> selection) {
    double sum = 0;
    double length = 0;
    for (const std::uint32_t bead : selection) {
        const double along = beadLength(toolpath, toolpath.beads[bead]);
        sum += along * static_cast<double>(toolpath.beads[bead].width);
        length += along;
    }
    return length > 0 ? sum / length : 0;
}

double sectionArea(double width, double height) {
    constexpr double kQuarterPi = std::numbers::pi / 4;
    if (width < height) return kQuarterPi * width * width;
    return height * (width - height * (1 - kQuarterPi));
}

double sectionWidth(double area, double height) {
    constexpr double kQuarterPi = std::numbers::pi / 4;
    if (area < kQuarterPi * height * height) return std::sqrt(area / kQuarterPi);
    return area / height + height * (1 - kQuarterPi);
}

double beadVolume(const Toolpath& toolpath, const Bead& bead) {
    return sectionArea(static_cast<double>(bead.width), static_cast<double>(toolpath.runOf(bead).height)) *
           beadLength(toolpath, bead);
}

double beadVolume(const Toolpath& toolpath) {
    double volume = 0;
    for (std::uint32_t n = 0; n < toolpath.beads.size(); ++n) volume += laidVolume(toolpath, n);
    return volume;
}

double laidVolume(const Toolpath& toolpath, std::uint32_t index) {
    return toolpath.flow.empty() ? beadVolume(toolpath, toolpath.beads[index])
                                 : static_cast<double>(toolpath.flow[index].volume);
}

}  // namespace stratum::gcode
