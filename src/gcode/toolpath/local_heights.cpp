#include "gcode/toolpath/local_heights.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>

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
        const auto index = [](double value) {
            return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(value / kCell)) + (1LL << 31));
        };
        Cell& cell = cells_[index(x) << 32U | index(y)];
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
    std::unordered_map<std::uint64_t, Cell> cells_;
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
        const double length = std::hypot(bead.x1 - bead.x0, bead.y1 - bead.y0);
        const int count = static_cast<int>(std::clamp(std::ceil(length / kCell), 1.0, double{kMostSamples}));
        for (int k = 0; k < count; ++k) {
            const double t = (k + 0.5) / count;
            const double rise = grid.visit(bead.x0 + t * (bead.x1 - bead.x0), bead.y0 + t * (bead.y1 - bead.y0),
                                           bead.z0 + t * (bead.z1 - bead.z0), path + t * length);
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

}  // namespace stratum::gcode
