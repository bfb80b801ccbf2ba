#include "voxelize/grid/deposit_balance.h"

#include "base/parallel_for.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/leaf/print_columns.h"
#include "voxelize/swell/layer_needs.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace stratum::voxelize {
namespace {

// Integers, because their sum does not depend on the order of threads; mm^3.
constexpr double kUnit = 1e-9;
std::int64_t unitsOf(double volume) { return std::llround(volume / kUnit); }

// mm, of a section at the distance `d` (mm) from its flat.
double thickness(const Layer& layer, double d) {
    if (d <= 0) return 2 * layer.halfHeight();
    return d < layer.radius ? 2 * (layer.half_side + std::sqrt(layer.radius * layer.radius - d * d)) : 0;
}

// Columns of 0.4 mm, whatever the voxels are; of large beads, as wide as the lowest layer is high, so that a bead of
// some width has as many points.
Lattice measuringLattice(const gcode::Toolpath& toolpath) {
    constexpr double kSpacing = 0.05;  // mm
    Lattice lattice;
    lattice.voxel_size = kSpacing * settlingScale(toolpath);
    lattice.half_width = 2;  // points lie up to a voxel beyond a leaf's outer samples
    return lattice;
}

double pointArea(const Lattice& lattice) { return lattice.voxel_size * lattice.voxel_size; }

double thicknessAt(const Layer& layer, const PlanField& sides2, std::size_t c) {
    return thickness(layer, std::sqrt(static_cast<double>(sides2.v[c])));
}

// With its outlines moved out.
double swollenAt(const LeafColumn::LayerPlan& plan, std::size_t c) {
    return thicknessAt(*plan.layer, plan.swollen != nullptr ? *plan.swollen : *plan.sides2, c);
}

// By which the top over a point of that thickness is moved up. The upper half loses no more than half of it: see
// PlaneTerm::rise.
double riseAt(const LeafColumn::LayerPlan& plan, std::size_t c, double held) {
    return plan.rise != nullptr ? std::max(static_cast<double>(plan.rise->v[c]), -0.25 * held) : 0;
}

// By how much more each point of a layer holds swollen and raised, mm, and where it has plastic.
struct Pressed {
    double out = 0;
    std::uint64_t solid = 0;
    std::array<double, kColumnSamples> up{};  // if nothing lies on it
};

Pressed pressedOf(const LeafColumn::LayerPlan& plan) {
    Pressed pressed;
    for (std::size_t c = 0; c < kColumnSamples; ++c) {
        const double solid = swollenAt(plan, c);
        if (plan.swollen != nullptr) pressed.out += solid - thicknessAt(*plan.layer, *plan.sides2, c);
        if (!(solid > 0)) continue;
        pressed.solid |= std::uint64_t{1} << c;
        pressed.up[c] = riseAt(plan, c, solid);
    }
    return pressed;
}

struct Sums {
    explicit Sums(std::size_t layers) : by_layer(layers) {}

    void add(const gcode::Run& run, double volume) {
        const std::int64_t units = unitsOf(volume);
        by_feature[static_cast<std::size_t>(run.feature)] += units;
        by_layer[run.layer] += units;
    }

    std::array<std::int64_t, gcode::kFeatureCount> by_feature{};
    std::vector<std::int64_t> by_layer;
    std::int64_t pressed_out = 0, raised = 0, shared = 0;
    // Scratch.
    std::vector<double> shares;
    std::vector<OpenTop> tops;
    std::vector<Pressed> pressed;
};

// The intervals of heights that the beads of a column have over its points, joined.
class JoinedHeights {
public:
    double heights = 0;  // mm, of the union over all points
    double shared = 0;   // mm, of what there is twice

    explicit JoinedHeights(const LeafColumn& column) : keep_(column.hasDirect()) {
        top_.fill(std::numeric_limits<double>::lowest());
    }

    void add(const LeafColumn::LayerPlan& plan) {
        for (std::size_t c = 0; c < kColumnSamples; ++c) {
            const double held = swollenAt(plan, c);
            const double half = 0.5 * held;
            if (!(half > 0)) continue;
            const double low = plan.layer->center_z - half;
            const double flat = plan.layer->center_z + half;
            const double top = flat + riseAt(plan, c, held);
            if (keep_) pieces_.push_back({c, {low, top}});
            if (low >= top_[c]) {
                heights += top - low;
                low_[c] = low;
            } else {
                // Layers ascend by their center planes, and a thick one can begin below a thin one before it.
                heights += std::max(top - top_[c], 0.0) + std::max(low_[c] - low, 0.0);
                // What a raised top shares with the layer on it was not counted as its own.
                shared += std::max(std::min(flat, flat_[c]) - std::max(low, low_[c]), 0.0);
                low_[c] = std::min(low_[c], low);
            }
            top_[c] = std::max(top_[c], top);
            flat_[c] = std::max(flat_[c], flat);
        }
    }

    // The sloped and round beads of the column, after its layers. Calls own(bead, heights) with the mm over all points
    // that each has.
    template <typename Own>
    void addDirect(const gcode::Toolpath& toolpath, const LeafColumn& column, const Own& own) {
        if (!keep_) return;
        double sum = heights;
        column.forEachDirect([&](std::uint32_t bead) {
            const BeadField field(toolpath, toolpath.beads[bead]);
            double has = 0;
            for (std::size_t c = 0; c < kColumnSamples; ++c) {
                const gcode::PlanPoint at = column.sample(c);
                const std::optional<Extent> met = field.heights(at.x, at.y);
                if (!met) continue;
                has += met->z_max - met->z_min;
                pieces_.push_back({c, *met});
            }
            sum += has;
            if (has > 0) own(bead, has);
        });
        heights = joinPieces();
        shared += sum - heights;
    }

private:
    struct Piece {
        std::size_t point = 0;
        Extent extent;
    };
    double joinPieces() {
        std::sort(pieces_.begin(), pieces_.end(), [](const Piece& a, const Piece& b) {
            return std::pair{a.point, a.extent.z_min} < std::pair{b.point, b.extent.z_min};
        });
        double sum = 0;
        std::size_t point = kColumnSamples;  // none
        double top = 0;
        for (const Piece& piece : pieces_) {
            if (piece.point != point) top = std::numeric_limits<double>::lowest();
            point = piece.point;
            sum += std::max(piece.extent.z_max - std::max(piece.extent.z_min, top), 0.0);
            top = std::max(top, piece.extent.z_max);
        }
        return sum;
    }

    const bool keep_;  // only where sloped and round beads will be added
    std::vector<Piece> pieces_;
    std::array<double, kColumnSamples> low_{}, top_{}, flat_{};
};

// Calls add(bead, volume) for the parts of one column of a layer, as far as grooves hold them.
template <typename Add>
void addLayer(const LayerStack& stack, const LeafColumn::LayerPlan& plan, double point_area,
              std::vector<double>& shares, const Add& add) {
    const std::size_t beads = plan.beads.size();
    shares.assign(2 * beads, 0.0);  // own thickness, then the sum of parts
    for (std::size_t c = 0; c < kColumnSamples; ++c) {
        const double solid = thicknessAt(*plan.layer, *plan.sides2, c);
        double sum = 0;
        for (std::size_t n = 0; n < beads; ++n)
            sum += shares[n] = thickness(*plan.layer, static_cast<double>(plan.beads[n].d.v[c]));
        if (!(sum > 0)) continue;
        for (std::size_t n = 0; n < beads; ++n) shares[beads + n] += solid * shares[n] / sum;
    }
    for (std::size_t n = 0; n < beads; ++n)
        if (shares[beads + n] > 0) add(stack.beads[plan.ranks[n]], shares[beads + n] * point_area);
}

// Calls visit(column) for each column that is open, on all threads.
template <typename Visit>
void forEachOpenColumn(const gcode::Toolpath& toolpath, const LayerStack& stack, std::uint32_t end,
                       const Visit& visit) {
    const Lattice lattice = measuringLattice(toolpath);
    const PrintColumns columns(toolpath, stack, lattice, 1, LeafColumn::Kind::spread);
    columns.forEach(end, [&visit](std::size_t, LeafColumn& column) { visit(column); });
}

// What the open tops of a column hold more, mm times points.
double raisedIn(const LayerStack& stack, std::vector<OpenTop>& tops, const std::vector<Pressed>& pressed) {
    coverTops(stack, tops);
    double sum = 0;
    for (std::size_t n = 0; n < tops.size(); ++n)
        for (std::size_t c = 0; c < kColumnSamples; ++c)
            if (tops[n].open >> c & 1) sum += pressed[n].up[c];
    return sum;
}

}  // namespace

DepositBalance balanceDeposit(const gcode::Toolpath& toolpath, const LayerStack& stack, std::uint32_t end) {
    const std::size_t layers = toolpath.layer_count + std::size_t{1};
    PerThread<Sums> threads([layers] { return Sums(layers); });
    const double point_area = pointArea(measuringLattice(toolpath));
    forEachOpenColumn(toolpath, stack, end, [&](LeafColumn& column) {
        Sums& sums = threads.local();
        sums.tops.clear();
        sums.pressed.clear();
        JoinedHeights joined(column);
        column.forEachLayer([&](const LeafColumn::LayerPlan& plan) {
            joined.add(plan);
            addLayer(stack, plan, point_area, sums.shares, [&](std::uint32_t bead, double volume) {
                sums.add(toolpath.runOf(toolpath.beads[bead]), volume);
            });
            if (stack.swell == nullptr) return;
            const Pressed& pressed = sums.pressed.emplace_back(pressedOf(plan));
            sums.pressed_out += unitsOf(pressed.out * point_area);
            addTop(static_cast<std::uint32_t>(plan.layer - stack.layers.data()), pressed.solid, sums.tops);
        });
        joined.addDirect(toolpath, column, [&](std::uint32_t bead, double heights) {
            sums.add(toolpath.runOf(toolpath.beads[bead]), heights * point_area);
        });
        sums.shared += unitsOf(joined.shared * point_area);
        if (stack.swell != nullptr) sums.raised += unitsOf(raisedIn(stack, sums.tops, sums.pressed) * point_area);
    });
    Sums laid(layers);
    Sums fed(layers);
    for (const Sums& one : threads) {
        laid.pressed_out += one.pressed_out;
        laid.raised += one.raised;
        laid.shared += one.shared;
        for (std::size_t f = 0; f < one.by_feature.size(); ++f) laid.by_feature[f] += one.by_feature[f];
        for (std::size_t l = 0; l < layers; ++l) laid.by_layer[l] += one.by_layer[l];
    }
    for (std::uint32_t rank = 0; rank < stack.beads.size(); ++rank) {
        if (stack.beads[rank] >= end) continue;
        fed.add(toolpath.runOf(toolpath.beads[stack.beads[rank]]), gcode::laidVolume(toolpath, stack.beads[rank]));
    }
    DepositBalance balance;
    balance.layers.resize(layers);
    const auto mm3 = [](std::int64_t units) { return static_cast<double>(units) * kUnit; };
    balance.pressed_out = mm3(laid.pressed_out);
    balance.raised = mm3(laid.raised);
    balance.shared = mm3(laid.shared);
    for (std::size_t f = 0; f < balance.features.size(); ++f) {
        balance.features[f] = {mm3(fed.by_feature[f]), mm3(laid.by_feature[f])};
        balance.all.fed += balance.features[f].fed;
        balance.all.laid += balance.features[f].laid;
    }
    for (std::size_t l = 0; l < layers; ++l) balance.layers[l] = {mm3(fed.by_layer[l]), mm3(laid.by_layer[l])};
    return balance;
}

double solidVolume(const gcode::Toolpath& toolpath, const LayerStack& stack, std::uint32_t end) {
    std::atomic<std::int64_t> sum{0};
    const double point_area = pointArea(measuringLattice(toolpath));
    forEachOpenColumn(toolpath, stack, end, [&](LeafColumn& column) {
        JoinedHeights joined(column);
        column.forEachLayer([&](const LeafColumn::LayerPlan& plan) { joined.add(plan); });
        joined.addDirect(toolpath, column, [](std::uint32_t, double) {});
        sum.fetch_add(unitsOf(joined.heights * point_area), std::memory_order_relaxed);
    });
    return static_cast<double>(sum.load()) * kUnit;
}

std::vector<float> overfillOfBeads(const gcode::Toolpath& toolpath, const LayerStack& stack) {
    // Sums in integers, as above: those of a bead are met in any order.
    std::vector<std::atomic<std::int64_t>> laid(toolpath.beads.size());
    PerThread<std::vector<double>> scratch;
    const double point_area = pointArea(measuringLattice(toolpath));
    const auto end = static_cast<std::uint32_t>(toolpath.beads.size());
    forEachOpenColumn(toolpath, stack, end, [&](LeafColumn& column) {
        column.forEachLayer([&](const LeafColumn::LayerPlan& plan) {
            addLayer(stack, plan, point_area, scratch.local(), [&](std::uint32_t bead, double volume) {
                laid[bead].fetch_add(unitsOf(volume), std::memory_order_relaxed);
            });
        });
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
