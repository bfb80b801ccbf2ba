#include "gcode/toolpath/sections.h"

#include "gcode/toolpath/ramps.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <unordered_map>
#include <vector>

namespace stratum::gcode {
namespace {

constexpr double kCell = 1;          // mm, two beads wide
constexpr double kSamePass = 8;      // mm of path; shorter than the turn of any spiral that can be printed
constexpr double kLeastRise = 0.01;  // mm; less is the same level
constexpr int kMostSamples = 4096;   // of one bead: a bound for damaged files
constexpr float kNothing = -std::numeric_limits<float>::infinity();

struct Cell {
    float top = kNothing;
    float below = kNothing;
    double visited = 0;  // mm along the whole path
};

class Grid {
public:
    // The rise of a nozzle at (x, y, z), after `path` mm, above the material below; 0 if there is none. Marks the cell.
    double visit(double x, double y, double z, double path) {
        Cell* const known =
            cellAt(static_cast<std::int64_t>(std::floor(x / kCell)), static_cast<std::int64_t>(std::floor(y / kCell)));
        if (known == nullptr) return 0;
        Cell& cell = *known;
        const auto level = static_cast<float>(z);
        const double above = z - static_cast<double>(cell.top);
        const bool same = path - cell.visited < kSamePass || std::abs(above) < kLeastRise;
        double rise = 0;
        if (cell.top == kNothing) {
            cell.top = level;
        } else if (same) {
            rise = z - static_cast<double>(cell.below);
            cell.top = std::max(cell.top, level);
        } else if (above > 0) {
            rise = above;
            cell.below = cell.top;
            cell.top = level;
        } else {
            rise = z - static_cast<double>(cell.below);
            cell.below = std::max(cell.below, level);
        }
        cell.visited = path;
        return std::isfinite(rise) && rise >= kLeastRise ? rise : 0;
    }

private:
    // Squares of cells: the nozzle stays in one for several samples. Small, for damaged files with beads far apart.
    static constexpr int kShift = 2;
    static constexpr std::int64_t kEdge = 1 << kShift;
    using Square = std::array<Cell, std::size_t{kEdge} * kEdge>;
    static constexpr std::size_t kMostSquares = std::size_t{1} << 20;  // 16 m^2: a bound for damaged files

    // Null beyond that.
    Cell* cellAt(std::int64_t i, std::int64_t j) {
        const auto part = [](std::int64_t n) { return static_cast<std::uint64_t>((n >> kShift) + (1LL << 31)); };
        const std::uint64_t key = part(i) << 32U | part(j);
        if (last_ == nullptr || key != last_key_) {
            const auto found = squares_.find(key);
            if (found == squares_.end() && squares_.size() >= kMostSquares) return nullptr;
            last_ = found != squares_.end() ? &found->second : &squares_[key];
            last_key_ = key;
        }
        return &(*last_)[static_cast<std::size_t>(i & (kEdge - 1)) * kEdge + static_cast<std::size_t>(j & (kEdge - 1))];
    }

    std::unordered_map<std::uint64_t, Square> squares_;
    Square* last_ = nullptr;
    std::uint64_t last_key_ = 0;
};

LocalRise summarize(std::vector<float>& rises, std::size_t samples) {
    if (rises.empty()) return {};
    const auto middle = rises.begin() + static_cast<std::ptrdiff_t>(rises.size() / 2);
    std::nth_element(rises.begin(), middle, rises.end());
    return {.median = static_cast<double>(*middle),
            .share = static_cast<double>(rises.size()) / static_cast<double>(samples)};
}

}  // namespace

std::vector<LocalRise> localRises(const Toolpath& toolpath, const std::vector<bool>& wanted) {
    std::vector<LocalRise> result(toolpath.runs.size());
    Grid grid;
    double path = 0;
    std::vector<float> rises;
    std::size_t samples = 0;
    for (std::size_t i = 0; i < toolpath.beads.size(); ++i) {
        const Bead& bead = toolpath.beads[i];
        const bool last_of_run = i + 1 == toolpath.beads.size() || toolpath.beads[i + 1].run != bead.run;
        if (toolpath.runOf(bead).layer == 0) continue;
        // Arcs by their chord, whose ends are sufficient for the material below.
        const double dx = bead.x1 - bead.x0;
        const double dy = bead.y1 - bead.y0;
        const double length = std::sqrt(dx * dx + dy * dy);  // std::hypot guards against overflow, at a price
        const int count = static_cast<int>(std::clamp(std::ceil(length / kCell), 1.0, double{kMostSamples}));
        for (int k = 0; k < count; ++k) {
            const double t = (k + 0.5) / count;
            const double rise =
                grid.visit(bead.x0 + t * dx, bead.y0 + t * dy, bead.z0 + t * (bead.z1 - bead.z0), path + t * length);
            if (!wanted[bead.run]) continue;
            ++samples;
            if (rise > 0) rises.push_back(static_cast<float>(rise));
        }
        path += length;
        if (!last_of_run) continue;
        if (samples > 0) result[bead.run] = summarize(rises, samples);
        rises.clear();
        samples = 0;
    }
    return result;
}

namespace {

constexpr double kFallbackHeight = 0.2;  // mm
constexpr double kLevelsPerMm = 1e5;     // less is rounding
constexpr double kLeastHeight = 0.01;    // mm; levels closer than this are one level
constexpr double kMostNominals = 4;      // a larger gap, in layers, is empty space, not a layer
constexpr double kMostRise = 3;          // mm, the same for files without a layer height
constexpr double kMostBridge = 1.5;      // mm of diameter of a bridging thread
constexpr double kNearNominal = 0.05;    // relative error due to cells of a millimetre
constexpr double kSpiralShare = 0.25;    // share of a run's length that must have material below to find its height
constexpr double kLevelShare = 0.3;
constexpr double kBedShare = 0.1;

// A thread that goes up rather than along.
bool isStrut(const Bead& bead) {
    const double rise = bead.z1 - bead.z0;
    const double x = bead.x1 - bead.x0;
    const double y = bead.y1 - bead.y0;
    return rise > 0 && rise * rise > x * x + y * y;
}

// z levels of level beads in parts of a millimetre, ascending. Prime lines (layer 0) are no levels of the part. A strut
// holds what is laid on its top: its level is `nominal` mm below that.
std::vector<std::int64_t> levelsOf(const Toolpath& toolpath, std::span<const double> run_z, double nominal) {
    std::vector<std::int64_t> levels;
    for (const Bead& bead : toolpath.beads) {
        const Run& run = toolpath.runOf(bead);
        const bool sloped = std::isnan(run_z[bead.run]);
        if (run.layer == 0 || (sloped && !isStrut(bead))) continue;
        const std::int64_t z = std::llround((sloped ? bead.z1 - nominal : +bead.z1) * kLevelsPerMm);
        if (levels.empty() || levels.back() != z) levels.push_back(z);
    }
    std::sort(levels.begin(), levels.end());
    levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
    return levels;
}

// The z of the next lower level, or of the bed.
double levelBelow(const std::vector<std::int64_t>& levels, double z) {
    const auto ceiling = std::llround((z - kLeastHeight) * kLevelsPerMm);
    const auto above = std::upper_bound(levels.begin(), levels.end(), ceiling);
    return above == levels.begin() ? 0 : std::max(0.0, static_cast<double>(*(above - 1)) / kLevelsPerMm);
}

double nearNominal(double height, std::optional<double> nominal) {
    return nominal && std::abs(height - *nominal) < kNearNominal * *nominal ? *nominal : height;
}

// Whether the print is a plain stack of equal layers, except the first. Only otherwise local heights are needed.
bool isPlainStack(const Toolpath& toolpath, std::span<const double> run_z, std::span<const double> heights) {
    double before = 0;
    double usual = 0;
    for (std::size_t k = 0; k < toolpath.runs.size(); ++k) {
        const double z = run_z[k];
        if (toolpath.runs[k].layer == 0) continue;
        if (std::isnan(z)) return false;
        if (std::abs(z - before) <= kLeastHeight) continue;
        const double expected = z > before ? z - before : z;
        if (std::abs(heights[k] - expected) > kLeastHeight) return false;
        const bool on_bed = std::abs(heights[k] - z) <= kLeastHeight;
        if (!on_bed && usual == 0) usual = heights[k];
        if (!on_bed && std::abs(heights[k] - usual) > kLeastHeight) return false;
        before = z;
    }
    return true;
}

// Heights of runs whose local height differs from that of the print's levels. Consecutive runs of one level get a
// common height.
void correctByPlace(const Toolpath& toolpath, std::span<const double> run_z, std::optional<double> nominal,
                    double first_level, std::vector<double>& heights) {
    std::vector<bool> wanted(toolpath.runs.size());
    for (std::size_t k = 0; k < wanted.size(); ++k) {
        const Run& run = toolpath.runs[k];
        wanted[k] = !(run.height > 0) && run.layer > 0;
    }
    const std::vector<LocalRise> rises = localRises(toolpath, wanted);
    const double most = nominal ? kMostNominals * *nominal : kMostRise;
    const auto is_turn = [most](const LocalRise& rise) {
        return rise.share > kSpiralShare && rise.median >= kLeastHeight && rise.median <= most;
    };
    double spiral = 0;
    for (std::size_t k = 0; k < heights.size(); ++k) {
        if (!wanted[k]) continue;
        const LocalRise& rise = rises[k];
        if (std::isnan(run_z[k])) {
            if (is_turn(rise)) spiral = rise.median;
            if (spiral > 0) heights[k] = nearNominal(spiral, nominal);
        } else if (rise.share > kLevelShare) {
            if (rise.median > heights[k] + kLeastHeight && rise.median <= most) heights[k] = rise.median;
        } else if (rise.share < kBedShare && run_z[k] <= 2 * first_level) {
            heights[k] = run_z[k];  // no material below, near the bed: the next object's first layer
        }
    }
    // A spiral's first turn has no material below; it gets the height of the next turn.
    for (std::size_t k = heights.size(); k-- > 0;) {
        if (!wanted[k] || !std::isnan(run_z[k])) continue;
        if (is_turn(rises[k]))
            spiral = rises[k].median;
        else if (spiral > 0)
            heights[k] = nearNominal(spiral, nominal);
    }
    // Moves without a Z in the middle of it belong to it.
    std::vector<double> length(toolpath.runs.size());
    for (const Bead& bead : toolpath.beads) length[bead.run] += beadLength(toolpath, bead);
    const auto slopes = [&](std::size_t k) { return wanted[k] && std::isnan(run_z[k]); };
    for (std::size_t k = 1; k + 1 < heights.size(); ++k)
        if (wanted[k] && !slopes(k) && slopes(k - 1) && slopes(k + 1) && length[k] < kSamePass && heights[k - 1] > 0)
            heights[k] = heights[k - 1];
}

// Bridging threads and ironing are round in any layer, and so is what hangs high above the bed with nothing between:
// their height follows from their own area. `in_air`: whether the latter is done.
void roundByArea(const Toolpath& toolpath, std::span<const double> run_z, bool in_air, std::vector<double>& heights) {
    constexpr double kHigh = 2;  // diameters
    std::vector<double> area(toolpath.runs.size());
    std::vector<double> length(toolpath.runs.size());
    for (const Bead& bead : toolpath.beads) {
        const double one = beadLength(toolpath, bead);
        area[bead.run] += static_cast<double>(bead.width) * one;
        length[bead.run] += one;
    }
    for (std::size_t k = 0; k < heights.size(); ++k) {
        const Run& run = toolpath.runs[k];
        if (run.height > 0 || !(length[k] > 0)) continue;
        const double diameter = 2 * std::sqrt(area[k] / length[k] / std::numbers::pi);
        if (run.feature == Feature::bridge) heights[k] = std::max(heights[k], std::min(diameter, kMostBridge));
        if (run.feature == Feature::ironing && heights[k] >= kLeastHeight)
            heights[k] = std::clamp(diameter, kLeastHeight, heights[k]);
        if (in_air && run.layer > 0 && !std::isnan(run_z[k]) && heights[k] > std::max(kHigh * diameter, kMostRise))
            heights[k] = std::max(diameter, kLeastHeight);
    }
}

// In files without a layer height the layers of a spiral were counted with a guessed height.
void recountSpiral(Toolpath& toolpath, std::span<const double> run_z, const std::vector<double>& heights) {
    std::vector<double> top(toolpath.runs.size());
    std::vector<bool> strut(toolpath.runs.size());
    for (const Bead& bead : toolpath.beads) {
        top[bead.run] = std::max(bead.z0, bead.z1);
        if (isStrut(bead)) strut[bead.run] = true;
    }
    const auto most = static_cast<double>(toolpath.beads.size());  // a turn has a bead at least
    double layer = 0;
    double before = 0;
    for (std::size_t k = 0; k < toolpath.runs.size(); ++k) {
        Run& run = toolpath.runs[k];
        if (run.layer == 0 || strut[k]) continue;
        if (!std::isnan(run_z[k])) {
            layer = std::max(layer, static_cast<double>(run.layer));
        } else if (before > 0 && heights[k] > 0) {
            layer = std::min(layer + (top[k] - before) / heights[k], most);
            run.layer = static_cast<std::uint32_t>(std::clamp(std::ceil(layer - 0.05), 1.0, most));
        }
        before = top[k];
    }
}

class Nominal {
public:
    Nominal(std::optional<double> height, WarningLog& warnings) : height_(height), warnings_(warnings) {}

    double at(std::uint32_t line) {
        if (height_) return *height_;
        warnings_.add("the file doesn't tell its layer height; 0.2 mm is used (set it with --layer-height)", line);
        return kFallbackHeight;
    }

private:
    std::optional<double> height_;
    WarningLog& warnings_;
};

}  // namespace

std::vector<double> findHeights(Toolpath& toolpath, std::span<const double> run_z, std::optional<double> nominal,
                                WarningLog& warnings) {
    const std::size_t count = toolpath.runs.size();
    const std::vector<std::int64_t> levels = levelsOf(toolpath, run_z, nominal.value_or(kFallbackHeight));
    std::vector<double> heights(count);
    for (std::size_t k = 0; k < count; ++k) {
        const Run& run = toolpath.runs[k];
        heights[k] = run.height > 0         ? static_cast<double>(run.height)
                     : std::isnan(run_z[k]) ? nominal.value_or(0)
                     : run.layer > 0        ? run_z[k] - levelBelow(levels, run_z[k])
                                            : run_z[k];
    }
    if (!isPlainStack(toolpath, run_z, heights)) {
        const double first_level = levels.empty() ? 0 : static_cast<double>(levels.front()) / kLevelsPerMm;
        correctByPlace(toolpath, run_z, nominal, first_level, heights);
        if (!nominal) recountSpiral(toolpath, run_z, heights);
    }
    roundByArea(toolpath, run_z, !nominal, heights);

    std::vector<std::uint32_t> lines(count);
    for (auto bead = toolpath.beads.rbegin(); bead != toolpath.beads.rend(); ++bead)
        lines[bead->run] = toolpath.lineOf(*bead);
    Nominal fallback(nominal, warnings);
    for (std::size_t k = 0; k < count; ++k) {
        const Run& run = toolpath.runs[k];
        double& height = heights[k];
        if (run.height > 0) continue;
        if (run.layer == 0) {
            // A prime line rests on the bed, unless it is a blob above it.
            const double usual = nominal ? *nominal : height <= kMostRise / 2 ? height : fallback.at(lines[k]);
            if (!(height >= kLeastHeight && height <= 2 * usual)) height = usual;
        } else if (std::isnan(run_z[k])) {
            if (!(height > 0)) height = fallback.at(lines[k]);
        } else if (!(height >= kLeastHeight)) {
            warnings.add("extrusion at or below the bed (z <= 0); the nominal layer height is used", lines[k]);
            height = fallback.at(lines[k]);
        } else if (nominal && height > kMostNominals * *nominal) {
            warnings.add("extrusion far above anything below it; the nominal layer height is used", lines[k]);
            height = *nominal;
        }
        if (!(height > 0)) height = fallback.at(lines[k]);
    }
    return heights;
}

namespace {

constexpr double kMostHeights = 100;  // a bead wider than this many heights is a mistake
constexpr double kBlobHeights = 10;
constexpr double kMostIroned = 2;  // mm; layers that are pressed into a top are as thin as a hundredth of that
constexpr double kBlobLengths = 4;

double widthOf(const Toolpath& toolpath, const Bead& bead, double area, double height, WarningLog& warnings) {
    const double width = sectionWidth(area, height);
    if (width <= kBlobHeights * height) return width;
    if (toolpath.runOf(bead).feature == Feature::ironing && width <= kMostIroned) return width;
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
    double cut = 0;  // mm^3
    std::uint32_t cut_first = 0;
    for (Bead& bead : toolpath.beads) {
        const double height = static_cast<double>(toolpath.runOf(bead).height);
        const auto area = static_cast<double>(bead.width);
        const double width = widthOf(toolpath, bead, area, height, warnings);
        bead.width = static_cast<float>(width);
        if (width < kMostHeights * height) continue;
        const double length = beadLength(toolpath, bead);
        const double disc = width > kBlobLengths * length ? std::numbers::pi / 4 * width * width * height : 0;
        const double left = area * length - std::max(sectionArea(width, height) * length, disc);
        if (!(left > 1e-6 * area * length)) continue;
        if (cut == 0) cut_first = toolpath.lineOf(bead);
        cut += left;
    }
    constexpr double kWorthSaying = 0.01;
    if (cut > 0 && cut > kWorthSaying * (cut + beadVolume(toolpath)))
        warnings.add(fmt::format("{:.4g} mm^3 that were fed are in no bead, since beads were cut; is E damaged?", cut),
                     cut_first);
    if (!toolpath.cut_short.empty() && !toolpath.empty()) {
        const Bead& last = toolpath.beads.back();
        warnings.add(fmt::format("the program seems to be cut short ({}); its last layer is {}, at z = {:g} mm",
                                 toolpath.cut_short, toolpath.runOf(last).layer, double{last.z1}),
                     toolpath.lineOf(last));
    }
}

}  // namespace stratum::gcode
