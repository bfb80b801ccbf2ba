#include "voxelize/layer_stack.h"

#include "voxelize/bead_field.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace stratum::voxelize {

LayerStack stackLayers(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection) {
    LayerStack stack;
    // Keys in whole nanometres: relative moves accumulate rounding that must not split a layer.
    std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::uint32_t>> groups;
    for (const std::uint32_t index : selection) {
        const gcode::Bead& bead = toolpath.beads[index];
        const Section section = sectionOf(toolpath, bead);
        // A round bead has a radius of its own and would be a layer of one.
        if (bead.z0 != bead.z1 || section.half_flat == 0) {
            stack.direct.push_back(index);
            continue;
        }
        groups[{std::llround((bead.z0 - section.drop) * 1e6), std::llround(section.radius * 1e6)}].push_back(index);
    }
    stack.layers.reserve(groups.size());
    for (auto& [key, beads] : groups)
        stack.layers.push_back(
            {static_cast<double>(key.first) * 1e-6, static_cast<double>(key.second) * 1e-6, std::move(beads)});

    // Bottom planes in order, so that each top plane finds its partners by bisection.
    std::vector<std::pair<double, std::uint32_t>> bottoms;
    double widest_gap = 0;
    for (std::uint32_t i = 0; i < stack.layers.size(); ++i) {
        bottoms.emplace_back(stack.layers[i].centre_z - stack.layers[i].radius, i);
        widest_gap = std::max(widest_gap, kWeldGap * 2 * stack.layers[i].radius);
    }
    std::sort(bottoms.begin(), bottoms.end());
    for (std::uint32_t lower = 0; lower < stack.layers.size(); ++lower) {
        const Layer& below = stack.layers[lower];
        const double top = below.centre_z + below.radius;
        auto it = std::lower_bound(bottoms.begin(), bottoms.end(), std::pair{top - widest_gap, std::uint32_t{0}});
        for (; it != bottoms.end() && it->first <= top + widest_gap; ++it) {
            const Layer& above = stack.layers[it->second];
            const double limit = kWeldGap * 2 * std::min(below.radius, above.radius);
            if (it->second != lower && std::abs(it->first - top) <= limit) stack.welds.push_back({lower, it->second});
        }
    }
    std::sort(stack.welds.begin(), stack.welds.end(), [](const Weld& a, const Weld& b) {
        return std::pair{a.lower, a.upper} < std::pair{b.lower, b.upper};
    });
    return stack;
}

}  // namespace stratum::voxelize
