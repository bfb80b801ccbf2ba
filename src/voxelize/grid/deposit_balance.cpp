#include "voxelize/grid/deposit_balance.h"

#include "base/parallel_for.h"
#include "voxelize/leaf/leaf_column.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace stratum::voxelize {
namespace {

constexpr std::size_t kBalanceGrain = 16;
// Integers, because their sum does not depend on the order of threads; mm^3.
constexpr double kUnit = 1e-9;
std::int64_t unitsOf(double volume) { return std::llround(volume / kUnit); }

struct Sums {
    explicit Sums(std::size_t layers) : by_layer(layers) {}

    void add(const gcode::Run& run, double volume) {
        const std::int64_t units = unitsOf(volume);
        by_feature[static_cast<std::size_t>(run.feature)] += units;
        by_layer[run.layer] += units;
    }

    std::array<std::int64_t, gcode::kFeatureCount> by_feature{};
    std::vector<std::int64_t> by_layer;
};

// mm, of a section at the distance `d` (mm) from its flat.
double thickness(const Layer& layer, double d) {
    if (d <= 0) return 2 * layer.halfHeight();
    return d < layer.radius ? 2 * (layer.half_side + std::sqrt(layer.radius * layer.radius - d * d)) : 0;
}

// Calls add(bead, volume) for the parts of one column of a layer.
template <typename Add>
void addLayer(const LayerStack& stack, const LeafColumn::LayerPlan& plan, double scale, double sample_area,
              std::vector<double>& shares, const Add& add) {
    const std::size_t beads = plan.beads.size();
    shares.assign(2 * beads, 0.0);  // own thickness, then the sum of parts
    for (std::size_t c = 0; c < kColumnSamples; ++c) {
        double sum = 0;
        for (std::size_t n = 0; n < beads; ++n)
            sum += shares[n] = thickness(*plan.layer, static_cast<double>(plan.beads[n].d.v[c]) / scale);
        if (!(sum > 0)) continue;
        const double solid = thickness(*plan.layer, std::sqrt(static_cast<double>(plan.sides2->v[c])) / scale);
        for (std::size_t n = 0; n < beads; ++n) shares[beads + n] += solid * shares[n] / sum;
    }
    for (std::size_t n = 0; n < beads; ++n)
        if (shares[beads + n] > 0) add(stack.beads[plan.ranks[n]], shares[beads + n] * sample_area);
}

}  // namespace

DepositBalance balanceDeposit(const gcode::Toolpath& toolpath, const LayerStack& stack, const PlanBins& bins,
                              const Lattice& lattice, const ColumnSource& columns, std::uint32_t end) {
    const std::size_t layers = toolpath.layer_count + std::size_t{1};
    tbb::enumerable_thread_specific<Sums> threads([layers] { return Sums(layers); });
    parallelFor(bins.size(), kBalanceGrain, [&](std::size_t first, std::size_t last) {
        LeafColumn& column = columns();
        Sums& laid = threads.local();
        std::vector<double> scratch;
        const double sample_area = lattice.voxel_size * lattice.voxel_size;
        for (std::size_t c = first; c != last; ++c) {
            if (bins[c].empty()) continue;
            column.open(bins.originI(c), bins.originJ(c), bins[c], end);
            column.forEachLayer([&](const LeafColumn::LayerPlan& plan) {
                addLayer(stack, plan, column.scale(), sample_area, scratch, [&](std::uint32_t bead, double volume) {
                    laid.add(toolpath.runOf(toolpath.beads[bead]), volume);
                });
            });
        }
    });
    Sums laid(layers);
    Sums fed(layers);
    for (const Sums& one : threads) {
        for (std::size_t f = 0; f < one.by_feature.size(); ++f) laid.by_feature[f] += one.by_feature[f];
        for (std::size_t l = 0; l < layers; ++l) laid.by_layer[l] += one.by_layer[l];
    }
    for (std::uint32_t rank = 0; rank < stack.beads.size(); ++rank) {
        if (stack.beads[rank] >= end) continue;
        const gcode::Run& run = toolpath.runOf(toolpath.beads[stack.beads[rank]]);
        const double volume = gcode::laidVolume(toolpath, stack.beads[rank]);
        fed.add(run, volume);
        if (rank >= stack.first_direct) laid.add(run, volume);
    }
    DepositBalance balance;
    balance.layers.resize(layers);
    const auto mm3 = [](std::int64_t units) { return static_cast<double>(units) * kUnit; };
    for (std::size_t f = 0; f < balance.features.size(); ++f) {
        balance.features[f] = {mm3(fed.by_feature[f]), mm3(laid.by_feature[f])};
        balance.all.fed += balance.features[f].fed;
        balance.all.laid += balance.features[f].laid;
    }
    for (std::size_t l = 0; l < layers; ++l) balance.layers[l] = {mm3(fed.by_layer[l]), mm3(laid.by_layer[l])};
    return balance;
}

std::vector<float> overfillOfBeads(const gcode::Toolpath& toolpath, const LayerStack& stack, const Lattice& lattice) {
    const PlanBins bins(toolpath, stack, lattice, std::numeric_limits<std::size_t>::max());
    // Sums in integers, as above: those of a bead are met in any order.
    std::vector<std::atomic<std::int64_t>> laid(toolpath.beads.size());
    tbb::enumerable_thread_specific<LeafColumn> columns([&] { return LeafColumn(toolpath, stack, lattice, 1); });
    parallelFor(bins.size(), kBalanceGrain, [&](std::size_t first, std::size_t last) {
        LeafColumn& column = columns.local();
        std::vector<double> scratch;
        const double sample_area = lattice.voxel_size * lattice.voxel_size;
        const auto end = static_cast<std::uint32_t>(toolpath.beads.size());
        for (std::size_t c = first; c != last; ++c) {
            if (bins[c].empty()) continue;
            column.open(bins.originI(c), bins.originJ(c), bins[c], end);
            column.forEachLayer([&](const LeafColumn::LayerPlan& plan) {
                addLayer(stack, plan, 1, sample_area, scratch, [&](std::uint32_t bead, double volume) {
                    laid[bead].fetch_add(unitsOf(volume), std::memory_order_relaxed);
                });
            });
        }
    });
    std::vector<float> shares(toolpath.beads.size(), 0);
    for (std::uint32_t rank = 0; rank < stack.first_direct; ++rank) {
        const std::uint32_t bead = stack.beads[rank];
        const double fed = gcode::laidVolume(toolpath, bead);
        const double missing = fed - static_cast<double>(laid[bead].load()) * kUnit;
        if (fed > 0) shares[bead] = static_cast<float>(std::clamp(missing / fed, 0.0, 1.0));
    }
    return shares;
}

}  // namespace stratum::voxelize
