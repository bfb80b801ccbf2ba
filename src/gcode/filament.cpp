#include "gcode/filament.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::gcode {
namespace {

double areaOf(double diameter) { return std::numbers::pi / 4 * diameter * diameter; }

// Cura's Griffin files (Ultimaker 3 and later) count mm of filament, do not say of which, but state its volume.
std::optional<double> diameterFromVolume(const Footer& footer, const Machine& machine) {
    constexpr std::array kUsual{2.85, 3.0};  // mm; 1.75 is what is assumed anyway
    if (machine.filamentKnown() || footer.volume.empty() || !(machine.filamentMm() > 0)) return std::nullopt;
    const double stated = std::accumulate(footer.volume.begin(), footer.volume.end(), 0.0);
    const double diameter = std::sqrt(stated / machine.filamentMm() / areaOf(1));
    for (const double usual : kUsual)
        if (std::abs(diameter - usual) < 0.02 * usual) return usual;
    return std::nullopt;
}

// Replaces the assumed diameter: areas and volumes change, lengths don't.
void setDiameter(double diameter, std::string_view reason, Toolpath& toolpath) {
    const double ratio = areaOf(diameter) / areaOf(toolpath.filament_diameter);
    for (Bead& bead : toolpath.beads) bead.width *= static_cast<float>(ratio);
    toolpath.extruded_mm3 *= ratio;
    toolpath.filament_diameter = diameter;
    toolpath.extrusion_rule = fmt::format("mm of filament of {:g} mm ({})", diameter, reason);
}

// Filament laid before the first layer, in mm of E. Widths are areas.
double primeOf(const Toolpath& toolpath, const Machine& machine) {
    const std::vector<FlowChange>& changes = machine.flowChanges();
    auto change = changes.begin();
    double flow = 1;
    double mm = 0;
    for (std::size_t n = 0; n < toolpath.beads.size(); ++n) {
        for (; change != changes.end() && change->first_bead <= n; ++change) flow = change->factor;
        const Bead& bead = toolpath.beads[n];
        const Run& run = toolpath.runOf(bead);
        if (run.layer == 0)
            mm += static_cast<double>(bead.width) * beadLength(toolpath, bead) /
                  (areaOf(machine.filamentDiameter(run.tool)) * flow);
    }
    return mm;
}

// Whether a bead is as wide as its line is meant to be: threads over air and thin fillings are not.
bool isPlainLine(const Run& run) {
    switch (run.feature) {
        case Feature::bridge:
        case Feature::gap_fill:
        case Feature::ironing:
        case Feature::overhang_perimeter:
        case Feature::support:
        case Feature::support_interface:
        case Feature::custom:
            return false;
        default:
            return run.layer > 0 && run.height > 0;
    }
}

struct PlainLine {
    float width = 0;    // of its section, mm
    double length = 0;  // mm
};

// The width below which half of the length is: by length, since thousands of short pieces fill gaps that are narrower
// than a line. In linear time, for prints of ten million beads.
double medianByLength(std::vector<PlainLine>& lines, double length) {
    const auto narrower = [](const PlainLine& a, const PlainLine& b) { return a.width < b.width; };
    double below = 0;
    auto first = lines.begin();
    auto last = lines.end();
    while (last - first > 1) {
        const auto middle = first + (last - first) / 2;
        std::nth_element(first, middle, last, narrower);
        const double lower =
            std::accumulate(first, middle, 0.0, [](double sum, const PlainLine& line) { return sum + line.length; });
        if (below + lower > 0.5 * length) {
            last = middle;
        } else {
            below += lower;
            first = middle;
        }
    }
    return static_cast<double>(first->width);
}

}  // namespace

bool takeFilament(const Footer& footer, const Machine& machine, Toolpath& toolpath, WarningLog& warnings) {
    toolpath.filament_diameter = machine.filamentDiameter(0);
    toolpath.filament_mm = machine.filamentMm();
    toolpath.extruded_mm3 = machine.extrudedMm3();
    toolpath.extrusion_rule = machine.extrusionRule();
    toolpath.prime_mm = primeOf(toolpath, machine);
    toolpath.flushed_mm = machine.flushedMm();
    const std::optional<double> found = diameterFromVolume(footer, machine);
    if (found) {
        setDiameter(*found, "the volume that the file states", toolpath);
        warnings.add(fmt::format("the volume that the file states for {:.0f} mm of filament is that of {:g} mm "
                                 "filament, which is taken (--filament-diameter if not)",
                                 toolpath.filament_mm, *found),
                     1);
    }
    // A single number is the whole print's.
    std::vector<double> lengths = footer.length;
    for (std::size_t tool = 0; tool < std::min(lengths.size(), footer.flow.size()); ++tool)
        if (footer.flow[tool] > 0) lengths[tool] /= footer.flow[tool];
    for (std::size_t tool = 0; tool < footer.volume.size(); ++tool)
        lengths.push_back(footer.volume[tool] / areaOf(found.value_or(machine.filamentDiameter(tool))));
    toolpath.footer_mm = std::accumulate(lengths.begin(), lengths.end(), 0.0);
    if (lengths.size() > 1) toolpath.footer_by_tool = std::move(lengths);
    return found || machine.filamentKnown();
}

void chooseFilament(std::optional<double> nozzle, Toolpath& toolpath, WarningLog& warnings) {
    constexpr double kThick = 2.85;       // mm
    constexpr double kUsualNozzle = 0.4;  // mm, for which the two bounds are
    constexpr double kWidestThin = 0.21;  // mm, of lines of 2.85 mm filament as if of 1.75 mm
    constexpr double kNarrowest = 0.33;   // mm, of lines of 1.75 mm filament
    constexpr double kWidest = 2.4;       // mm, of lines of a nozzle that nobody states
    constexpr std::size_t kEnough = 100;  // lines, for a choice
    constexpr std::size_t kFewest = 4;    // for a remark
    std::vector<PlainLine> lines_of_print;
    double length = 0;
    for (const Bead& bead : toolpath.beads) {
        const Run& run = toolpath.runOf(bead);
        if (!isPlainLine(run)) continue;
        lines_of_print.push_back({bead.width / run.height, beadLength(toolpath, bead)});
        length += lines_of_print.back().length;
    }
    if (lines_of_print.size() < kFewest) return;
    const double width = medianByLength(lines_of_print, length);
    const double scale = nozzle.value_or(kUsualNozzle) / kUsualNozzle;
    const bool wide = width >= kWidest * scale && lines_of_print.size() >= kEnough;
    if (!(width > 0) || (width >= kNarrowest * scale && !wide)) return;
    const double other = wide ? kUsualNozzle * scale : kThick;
    const double ratio = areaOf(other) / areaOf(toolpath.filament_diameter);
    const std::string lines = fmt::format(
        "the file doesn't say how thick its filament is; of {:g} mm filament its lines hold {:.2f} of what lines as "
        "wide "
        "as a nozzle of {:g} mm do",
        toolpath.filament_diameter, width / (kUsualNozzle * scale), kUsualNozzle * scale);
    if (wide)
        return warnings.add(
            fmt::format("{}; if E counts what comes out of the nozzle, as with firmwares of 2011 and before, say so "
                        "(--filament-diameter {:g}), for {:.2f} of it",
                        lines, other, ratio * width / (kUsualNozzle * scale)),
            1);
    if (width > kWidestThin * scale || lines_of_print.size() < kEnough)
        return warnings.add(fmt::format("{}; if it is {:g} mm, say so (--filament-diameter {:g}), for {:.2f} of it",
                                        lines, kThick, kThick, ratio * width / (kUsualNozzle * scale)),
                            1);
    const double before = toolpath.filament_diameter;
    setDiameter(kThick, "the width of its lines", toolpath);
    warnings.add(fmt::format("{}, of {:g} mm filament {:.2f}, which is taken (--filament-diameter {:g} if not)", lines,
                             kThick, ratio * width / (kUsualNozzle * scale), before),
                 1);
}

void warnOfMixedFilaments(const Machine& machine, const Toolpath& toolpath, WarningLog& warnings) {
    constexpr double kRatio = 1.75 * 1.75 / (2.85 * 2.85);
    constexpr double kTolerance = 0.03;  // of it: skirts, first layers and infill differ a little
    constexpr double kFewest = 100;      // mm of path, below which a mean says nothing
    if (machine.filamentKnown() || toolpath.filament_by_tool.size() < 2) return;
    struct Sum {
        double volume = 0;
        double face = 0;  // length times height
        double length = 0;
        std::uint32_t line = 0;
    };
    std::array<Sum, 256> sums{};
    for (const Bead& bead : toolpath.beads) {
        const Run& run = toolpath.runOf(bead);
        const double length = beadLength(toolpath, bead);
        const auto height = static_cast<double>(run.height);
        Sum& sum = sums[run.tool];
        if (sum.line == 0) sum.line = toolpath.lineOf(bead);
        sum.volume += length * sectionArea(static_cast<double>(bead.width), height);
        sum.face += length * height;
        sum.length += length;
    }
    std::size_t first = 0;
    while (first < sums.size() && sums[first].length < kFewest) ++first;
    for (std::size_t tool = first + 1; tool < sums.size(); ++tool) {
        if (sums[tool].length < kFewest) continue;
        const double ratio = sums[tool].volume / sums[tool].face / (sums[first].volume / sums[first].face);
        const bool thin = std::abs(ratio - kRatio) < kTolerance * kRatio;
        const bool thick = std::abs(1 / ratio - kRatio) < kTolerance * kRatio;
        if (!thin && !thick) continue;
        warnings.add(fmt::format("T{} lays {:.3f} of the section that T{} does, as E of {} filament would; if it is "
                                 "that, say so with --filament-diameter, e.g. {}",
                                 tool, ratio, first, thin ? "2.85 mm" : "1.75 mm", thin ? "1.75,2.85" : "2.85,1.75"),
                     sums[tool].line);
    }
}

}  // namespace stratum::gcode
