#include "report/plan/slabs.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stratum::report {
namespace {

// Empty if the layers do not ascend.
std::vector<Slab> byLayer(const gcode::Toolpath& toolpath, const voxelize::LayerStack& stack) {
    constexpr double kNoTop = std::numeric_limits<double>::lowest();
    std::vector<double> tops(toolpath.layer_count + std::size_t{1}, kNoTop);
    double bottom = std::numeric_limits<double>::max();
    for (const voxelize::Layer& layer : stack.layers) {
        bottom = std::min(bottom, layer.center_z - layer.halfHeight());
        double& top = tops.at(toolpath.runOf(toolpath.beads[stack.beads[layer.first]]).layer);
        top = std::max(top, layer.center_z + layer.halfHeight());
    }
    std::vector<Slab> slabs;
    for (const double top : tops) {
        if (top == kNoTop) continue;
        if (!(top > bottom)) return {};
        slabs.push_back({bottom, top});
        bottom = top;
    }
    return slabs;
}

std::vector<Slab> even(const SolidSums& sums, const voxelize::Lattice& lattice) {
    const double height = lattice.layer_height > 0 ? lattice.layer_height : lattice.voxel_size;
    std::size_t first = sums.rows.size();
    std::size_t last = 0;
    for (std::size_t r = 0; r < sums.rows.size(); ++r)
        if (sums.rows[r].solid > 0) {
            first = std::min(first, r);
            last = r + 1;
        }
    std::vector<Slab> slabs;
    const auto heightOf = [&](std::size_t row) {
        return lattice.origin_z + (sums.first_row + static_cast<double>(row)) * lattice.voxel_size;
    };
    for (double z = std::floor((heightOf(first) + 1e-6) / height) * height; first < last && z < heightOf(last) - 1e-6;
         z += height)
        slabs.push_back({z, z + height});
    return slabs;
}

}  // namespace

Slabs divideByLayer(const gcode::Toolpath& toolpath, const voxelize::LayerStack& stack,
                    const voxelize::Lattice& lattice, const SolidSums& sums) {
    Slabs result{byLayer(toolpath, stack), true};
    if (result.slabs.empty() || stack.first_direct < stack.beads.size() / 2) result = {even(sums, lattice), false};
    if (result.slabs.empty()) return result;
    const double cell = std::pow(lattice.voxel_size, 3);
    for (std::size_t r = 0; r < sums.rows.size(); ++r) {
        const double low = lattice.origin_z + (sums.first_row + static_cast<double>(r)) * lattice.voxel_size;
        const double high = low + lattice.voxel_size;
        for (std::size_t n = 0; n < result.slabs.size(); ++n) {
            Slab& slab = result.slabs[n];
            // What is below the first and above the last is theirs.
            const double from = n == 0 ? low : std::max(low, slab.bottom);
            const double to = n + 1 == result.slabs.size() ? high : std::min(high, slab.top);
            if (!(to > from)) continue;
            const double share = cell * std::min(1.0, (to - from) / lattice.voxel_size);
            slab.plastic += share * sums.rows[r].solid;
            slab.open += share * sums.rows[r].open;
            slab.closed += share * sums.rows[r].closed;
        }
    }
    return result;
}

}  // namespace stratum::report
