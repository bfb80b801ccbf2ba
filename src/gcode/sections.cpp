#include "gcode/sections.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

namespace stratum::gcode {
namespace {

constexpr double kFallbackHeight = 0.2;  // mm
constexpr double kLeastHeight = 0.01;    // mm; levels closer than this are one level
constexpr double kMostNominals = 4;      // a gap of more layers than this is air, not a layer
constexpr double kMostHeights = 100;     // a bead wider than this many heights is a mistake
constexpr double kBlobHeights = 10;
constexpr double kBlobLengths = 4;

// z levels of level beads in micrometres, ascending. Start-up lines (layer 0) are no levels of the part.
std::vector<std::int64_t> levelsOf(const Toolpath& toolpath, std::span<const double> run_z) {
    std::vector<std::int64_t> levels;
    for (const Bead& bead : toolpath.beads) {
        const Run& run = toolpath.runOf(bead);
        if (run.layer == 0 || std::isnan(run_z[bead.run])) continue;
        const std::int64_t z = std::llround(bead.z1 * 1000);
        if (levels.empty() || levels.back() != z) levels.push_back(z);
    }
    std::sort(levels.begin(), levels.end());
    levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
    return levels;
}

class HeightResolver {
public:
    HeightResolver(std::vector<std::int64_t> levels, std::optional<double> nominal, WarningLog& warnings)
        : levels_(std::move(levels)), nominal_(nominal), warnings_(warnings) {}

    double heightOf(const Run& run, double z, std::uint32_t line) {
        if (std::isnan(z)) return nominalAt(line);
        if (run.layer == 0) {
            const double nominal = nominalAt(line);
            return z >= kLeastHeight && z <= 2 * nominal ? z : nominal;
        }
        const double height = z - levelBelow(z);
        if (!(height >= kLeastHeight)) {
            warnings_.add("extrusion at or below the bed (z <= 0); the nominal layer height is used", line);
            return nominalAt(line);
        }
        if (nominal_ && height > kMostNominals * *nominal_) {
            warnings_.add("extrusion far above anything below it; the nominal layer height is used", line);
            return *nominal_;
        }
        return height;
    }

private:
    double levelBelow(double z) const {
        const auto ceiling = std::llround((z - kLeastHeight) * 1000);
        const auto above = std::upper_bound(levels_.begin(), levels_.end(), ceiling);
        return above == levels_.begin() ? 0 : std::max(0.0, static_cast<double>(*(above - 1)) / 1000);
    }

    double nominalAt(std::uint32_t line) {
        if (nominal_) return *nominal_;
        warnings_.add("the file doesn't tell its layer height; 0.2 mm is used (set it with --layer-height)", line);
        return kFallbackHeight;
    }

    std::vector<std::int64_t> levels_;
    std::optional<double> nominal_;
    WarningLog& warnings_;
};

double widthOf(const Toolpath& toolpath, const Bead& bead, double area, double height, WarningLog& warnings) {
    const double width = sectionWidth(area, height);
    if (width <= kBlobHeights * height) return width;
    const double length = beadLength(toolpath, bead);
    if (width > kBlobLengths * length) {
        warnings.add("blob: far more material than a bead of this length holds; drawn as a disc of that volume",
                     bead.line);
        return std::min(2 * std::sqrt(area * length / (std::numbers::pi * height)), kMostHeights * height);
    }
    if (width > kMostHeights * height) {
        warnings.add("bead wider than 100 layer heights; cut to that", bead.line);
        return kMostHeights * height;
    }
    return width;
}

}  // namespace

void resolveSections(Toolpath& toolpath, std::span<const double> run_z, std::optional<double> nominal_height,
                     WarningLog& warnings) {
    const bool all_tagged =
        std::all_of(toolpath.runs.begin(), toolpath.runs.end(), [](const Run& run) { return run.height > 0; });
    if (!all_tagged) {
        HeightResolver resolver(levelsOf(toolpath, run_z), nominal_height, warnings);
        for (const Bead& bead : toolpath.beads) {
            Run& run = toolpath.runs[bead.run];
            if (!(run.height > 0)) run.height = static_cast<float>(resolver.heightOf(run, run_z[bead.run], bead.line));
        }
    }
    for (Bead& bead : toolpath.beads) {
        const double height = static_cast<double>(toolpath.runOf(bead).height);
        bead.width = static_cast<float>(widthOf(toolpath, bead, static_cast<double>(bead.width), height, warnings));
    }
}

}  // namespace stratum::gcode
