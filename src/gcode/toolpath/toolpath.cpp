#include "gcode/toolpath/toolpath.h"

#include "gcode/toolpath/plan_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::gcode {

std::string describe(const DepositModel& deposit) {
    std::string section = "stadium";
    if (deposit.corner_mm)
        section = fmt::format("corners of {:g} mm", *deposit.corner_mm);
    else if (!deposit.stadium())
        section = fmt::format("corners of {:g} % of half the height", 100 * deposit.corner_fraction);
    std::string text = fmt::format("{}, {}",
                                   deposit.swells()    ? "settled"
                                   : deposit.settles() ? "grooves"
                                                       : "capsule",
                                   section);
    if (deposit.flow_lag) text += fmt::format(", flow lag {:g} s", *deposit.flow_lag);
    if (deposit.flow_lag && deposit.pressure_advance)
        text += fmt::format(", pressure advance {:g} s", *deposit.pressure_advance);
    if (deposit.strings) text += ", strings";
    if (deposit.sag > 0) text += fmt::format(", sag {:g} % of the span", 100 * deposit.sag);
    if (deposit.swells() && deposit.crown > 0)
        text += fmt::format(", crowns of {:g} % of the height", 100 * deposit.crown);
    return text;
}

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
    const double plan = PlanPath(toolpath, bead).length();
    const double rise = bead.z1 - bead.z0;
    return rise == 0 ? plan : std::hypot(plan, rise);
}

PathDirection pathDirection(const Toolpath& toolpath, const Bead& bead, double x, double y) {
    const PlanPath path(toolpath, bead);
    const PlanPoint plan = path.direction(path.nearest(x, y));
    return {path.length() * plan.x, path.length() * plan.y, bead.z1 - bead.z0};
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
