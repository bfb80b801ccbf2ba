#include "gcode/filament.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
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

}  // namespace

void takeFilament(const Footer& footer, const Machine& machine, Toolpath& toolpath, WarningLog& warnings) {
    toolpath.filament_diameter = machine.filamentDiameter(0);
    toolpath.filament_mm = machine.filamentMm();
    toolpath.extruded_mm3 = machine.extrudedMm3();
    toolpath.extrusion_rule = machine.extrusionRule();
    const std::optional<double> found = diameterFromVolume(footer, machine);
    if (found) {
        const double ratio = areaOf(*found) / areaOf(toolpath.filament_diameter);
        for (Bead& bead : toolpath.beads) bead.width *= static_cast<float>(ratio);
        toolpath.extruded_mm3 *= ratio;
        toolpath.filament_diameter = *found;
        toolpath.extrusion_rule = fmt::format("mm of filament of {:g} mm (the volume that the file states)", *found);
        warnings.add(fmt::format("the volume that the file states for {:.0f} mm of filament is that of {:g} mm "
                                 "filament, which is taken (--filament-diameter if not)",
                                 toolpath.filament_mm, *found),
                     1);
    }
    // A single number is the whole print's.
    std::vector<double> lengths = footer.length;
    for (std::size_t tool = 0; tool < footer.volume.size(); ++tool)
        lengths.push_back(footer.volume[tool] / areaOf(found.value_or(machine.filamentDiameter(tool))));
    toolpath.footer_mm = std::accumulate(lengths.begin(), lengths.end(), 0.0);
    if (lengths.size() > 1) toolpath.footer_by_tool = std::move(lengths);
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
