#include "report/level_set/outside.h"

#include "base/parallel_for.h"
#include "voxelize/grid/exterior.h"
#include "voxelize/leaf/leaf_flood.h"
#include "voxelize/leaf/leaf_kernels.h"

#include <algorithm>
#include <cmath>

namespace stratum::report {
namespace {

using voxelize::LeafFlood;
using voxelize::LeafMask;

constexpr std::size_t kGrain = 64;

// The samples whose distance from the plastic is at least that.
LeafMask openSamples(const Leaf& leaf, float least) {
    LeafMask mask;
    voxelize::maskFrom(leaf.buffer().data(), least, mask.word.data());
    return mask;
}

LeafFlood::Passable passableFrom(const LeafMap& map, float least) {
    return [&map, least](std::size_t, int, std::size_t n) { return openSamples(map.leaf(n), least); };
}

std::vector<std::uint8_t> gapsOf(const LeafFlood& flood, std::size_t count) {
    std::vector<std::uint8_t> reached(count);
    for (std::size_t n = 0; n < count; ++n) reached[n] = flood.reachedGap(n) ? 1 : 0;
    return reached;
}

// Calls body(n) for each leaf, on all threads.
template <typename Body>
void forEachLeaf(const LeafMap& map, const Body& body) {
    parallelFor(map.leafCount(), kGrain, [&](std::size_t first, std::size_t last) {
        for (std::size_t n = first; n != last; ++n) body(n);
    });
}

}  // namespace

Outside::Outside(const LeafMap& map, double clearance, double voxel, double background) {
    clearance = std::min(clearance, background - 0.5 * voxel);
    // From where the ball's middle can be into the bottom of a groove between two round sides of its radius.
    constexpr double kIntoGroove = 1.8;
    const int steps =
        std::max(voxelize::ExteriorRule{}.depth, static_cast<int>(std::ceil(kIntoGroove * clearance / voxel)) + 1);
    findShown(map, static_cast<float>(clearance), std::min(steps, voxelize::kFarthestReach));
    const LeafFlood::Passable passable = passableFrom(map, 0);
    LeafFlood flood(map.positions(), passable, map.solidGaps());
    flood.run();
    any_.resize(map.leafCount());
    forEachLeaf(map, [&](std::size_t n) {
        if (const LeafMask* reached = flood.reached(n)) any_[n] = *reached;
    });
    gap_any_ = gapsOf(flood, map.positions().gapCount());
}

void Outside::findShown(const LeafMap& map, float clearance, int depth) {
    const LeafFlood::Passable passable = passableFrom(map, clearance);
    LeafFlood wide(map.positions(), passable, map.solidGaps());
    wide.run();
    gap_wide_ = gapsOf(wide, map.positions().gapCount());
    std::vector<LeafMask> open(map.leafCount());
    forEachLeaf(map, [&](std::size_t n) { open[n] = openSamples(map.leaf(n), 0); });
    shown_.resize(map.leafCount());
    const auto gap_is_full = [this](std::size_t gap) { return gap_wide_[gap] != 0; };
    forEachLeaf(map, [&](std::size_t n) {
        const LeafMask* reached = wide.reached(n);
        // Nothing of a leaf without a place left to reach depends on its neighbours.
        if (open[n].empty() || (reached != nullptr && *reached == open[n])) {
            shown_[n] = open[n];
            return;
        }
        const std::size_t c = map.columnOf(n);
        const int k = map.leafK(n);
        const voxelize::Neighbourhood seeds = map.positions().around(
            c, k, [&](std::size_t slot) { return wide.reached(slot); }, gap_is_full);
        if (!voxelize::anyWithin(seeds, depth)) return;
        const voxelize::Neighbourhood air = map.positions().around(
            c, k, [&](std::size_t slot) { return &open[slot]; }, gap_is_full);
        shown_[n] = voxelize::spreadThrough(air, seeds, depth);
    });
}

}  // namespace stratum::report
