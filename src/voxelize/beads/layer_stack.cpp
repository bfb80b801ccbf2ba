#include "voxelize/beads/layer_stack.h"

#include "voxelize/beads/bead_field.h"
#include "voxelize/swell/swell_field.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

namespace stratum::voxelize {
namespace {

// Center plane and radius in whole nanometres, so that accumulated rounding of relative moves doesn't split a layer;
// and the layer's number, if it counts.
using LayerKey = std::tuple<std::int64_t, std::int64_t, std::uint32_t>;

constexpr std::uint32_t kDirect = 0xffffffff;

// Ascending layers with their beads' ranks, from the group of each selected bead.
void rankBeads(std::span<const std::uint32_t> selection, const std::vector<std::uint32_t>& group_of,
               const std::map<LayerKey, std::uint32_t>& groups, const gcode::DepositModel& deposit, LayerStack& stack) {
    std::vector<std::uint32_t> layer_of_group(groups.size());
    for (const auto& [key, group] : groups) {
        layer_of_group[group] = static_cast<std::uint32_t>(stack.layers.size());
        Layer layer;
        layer.center_z = static_cast<double>(std::get<0>(key)) * 1e-6;
        const double half_height = static_cast<double>(std::get<1>(key)) * 1e-6;
        layer.radius = deposit.cornerRadius(2 * half_height);
        layer.half_side = half_height - layer.radius;
        layer.inset = flatInset(2 * half_height, layer.radius);
        if (deposit.swells()) {
            layer.most_rise = std::min(kMostRise * stack.settling_scale, half_height);
            layer.crown = layer.radius > 0 ? 2 * half_height * deposit.crown : 0;
        }
        stack.layers.push_back(layer);
    }
    const auto layers = static_cast<std::uint32_t>(stack.layers.size());
    std::vector<std::uint32_t> next(stack.layers.size() + 2, 0);
    for (const std::uint32_t group : group_of) ++next[(group == kDirect ? layers : layer_of_group[group]) + 1];
    for (std::size_t l = 1; l < next.size(); ++l) next[l] += next[l - 1];
    for (std::uint32_t l = 0; l < layers; ++l) {
        stack.layers[l].first = next[l];
        stack.layers[l].last = next[l + 1];
    }
    stack.first_direct = next[layers];
    stack.beads.resize(selection.size());
    stack.layer.resize(selection.size());
    for (std::size_t n = 0; n < selection.size(); ++n) {
        const std::uint32_t layer = group_of[n] == kDirect ? layers : layer_of_group[group_of[n]];
        const std::uint32_t rank = next[layer]++;
        stack.beads[rank] = selection[n];
        stack.layer[rank] = layer;
    }
}

// Layers of one ratio of height and corner radius share a curve.
void addSettling(LayerStack& stack) {
    for (Layer& layer : stack.layers) {
        if (!(layer.radius > 0)) continue;  // sharp corners leave no groove
        const double ratio = 2 * layer.halfHeight() / layer.radius;
        const auto same = [ratio](const auto& curve) { return std::abs(curve->ratio() - ratio) <= 1e-9 * ratio; };
        auto known = std::find_if(stack.curves.begin(), stack.curves.end(), same);
        if (known == stack.curves.end())
            known = stack.curves.insert(known, std::make_shared<const SettlingCurve>(ratio, kWeldGap));
        layer.settling = known->get();
    }
}

void findWelds(LayerStack& stack) {
    // Top planes in order, so that each bottom plane finds its partners by bisection.
    std::vector<std::pair<double, std::uint32_t>> tops;
    tops.reserve(stack.layers.size());
    for (std::uint32_t i = 0; i < stack.layers.size(); ++i)
        tops.emplace_back(stack.layers[i].center_z + stack.layers[i].halfHeight(), i);
    std::sort(tops.begin(), tops.end());
    std::vector<std::uint32_t> lowers;
    for (std::uint32_t upper = 0; upper < stack.layers.size(); ++upper) {
        const Layer& above = stack.layers[upper];
        const double bottom = above.center_z - above.halfHeight();
        const double gap = kWeldGap * 2 * above.halfHeight();
        lowers.clear();
        auto it = std::lower_bound(tops.begin(), tops.end(), std::pair{bottom - gap, std::uint32_t{0}});
        for (; it != tops.end() && it->first <= bottom + gap; ++it) {
            const double limit = kWeldGap * 2 * std::min(stack.layers[it->second].halfHeight(), above.halfHeight());
            if (it->second != upper && std::abs(bottom - it->first) <= limit) lowers.push_back(it->second);
        }
        std::sort(lowers.begin(), lowers.end());
        for (const std::uint32_t lower : lowers) stack.welds.push_back({lower, upper});
    }
}

}  // namespace

LayerStack stackLayers(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection, LayersBy by) {
    LayerStack stack;
    std::map<LayerKey, std::uint32_t> groups;
    std::vector<std::uint32_t> group_of;
    group_of.reserve(selection.size());
    // Neighbours in print order nearly always share their layer.
    LayerKey last_key{};
    std::uint32_t last_group = kDirect;
    for (const std::uint32_t index : selection) {
        const gcode::Bead& bead = toolpath.beads[index];
        const Section section = sectionOf(toolpath, bead);
        // A round bead has a radius of its own and would be a layer of one.
        if (bead.z0 != bead.z1 || section.half_flat == 0) {
            group_of.push_back(kDirect);
            continue;
        }
        const LayerKey key{std::llround((bead.z0 - section.drop) * 1e6), std::llround(section.halfHeight() * 1e6),
                           by == LayersBy::plane_and_number ? toolpath.runOf(bead).layer : 0};
        if (last_group == kDirect || key != last_key) {
            last_group = groups.try_emplace(key, static_cast<std::uint32_t>(groups.size())).first->second;
            last_key = key;
        }
        group_of.push_back(last_group);
    }
    if (toolpath.deposit.swells()) {
        stack.settling_scale = settlingScale(toolpath);
        stack.swell = std::make_shared<const SwellField>();
    }
    rankBeads(selection, group_of, groups, toolpath.deposit, stack);
    if (toolpath.deposit.settles()) addSettling(stack);
    stack.extents.reserve(stack.direct().size());
    for (const std::uint32_t bead : stack.direct()) {
        const Bounds box = BeadField(toolpath, toolpath.beads[bead]).bounds();
        stack.extents.push_back({box.min[2], box.max[2]});
    }
    findWelds(stack);
    return stack;
}

}  // namespace stratum::voxelize
