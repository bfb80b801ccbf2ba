#include "gcode/toolpath/local_heights.h"

#include <algorithm>
#include <array>
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
        Cell& cell =
            cellAt(static_cast<std::int64_t>(std::floor(x / kCell)), static_cast<std::int64_t>(std::floor(y / kCell)));
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

    Cell& cellAt(std::int64_t i, std::int64_t j) {
        const auto part = [](std::int64_t n) { return static_cast<std::uint64_t>((n >> kShift) + (1LL << 31)); };
        const std::uint64_t key = part(i) << 32U | part(j);
        if (last_ == nullptr || key != last_key_) {
            last_ = &squares_[key];
            last_key_ = key;
        }
        return (*last_)[static_cast<std::size_t>(i & (kEdge - 1)) * kEdge + static_cast<std::size_t>(j & (kEdge - 1))];
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

}  // namespace stratum::gcode
