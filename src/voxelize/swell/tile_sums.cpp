#include "voxelize/swell/tile_sums.h"

#include "voxelize/leaf/leaf_column.h"
#include "voxelize/swell/open_top.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <utility>

namespace stratum::voxelize {
namespace {

constexpr int kNodes = TileSums::kNodes;
constexpr int kColumnCells = 2;
constexpr int kTileColumns = kTileCells / kColumnCells;
constexpr int kColumnNodes = kColumnCells + 1;

using Layers = std::map<std::uint32_t, std::unique_ptr<TileSums::Layer>>;
// The weights of a column's nodes at its points.
using Weights = std::array<PlanField, std::size_t{kColumnNodes} * kColumnNodes>;

Weights columnWeights(const ColumnGrid& points) {
    Weights weights{};
    // From the middle of the samples to that of the square.
    const double shift = 0.5 * cellLattice().voxel_size;
    for (int node = 0; node < kColumnNodes * kColumnNodes; ++node) {
        const int column = node % kColumnNodes;
        const int row = node / kColumnNodes;
        for (std::size_t c = 0; c < kColumnSamples; ++c) {
            const double x = (static_cast<double>(points.qx.v[c]) - shift) / kNodeSpacing + 1;
            const double y = (static_cast<double>(points.qy.v[c]) - shift) / kNodeSpacing + 1;
            weights[static_cast<std::size_t>(node)].v[c] = static_cast<float>(
                nodeShare(std::max(1 - std::abs(x - column), 0.0)) * nodeShare(std::max(1 - std::abs(y - row), 0.0)));
        }
    }
    return weights;
}

// The volume (mm^3) under the points of a column by node, less that with no swell for a swell > 0.
class ColumnSums {
public:
    ColumnSums()
        : points_(ColumnGrid::spread(static_cast<float>(cellLattice().voxel_size))), weights_(columnWeights(points_)) {}

    // Returns the points with plastic, bit c for point c.
    // `tops`: if not null, the highest plastic of the layers below at each point, mm: what this layer shares with them
    // it does not hold.
    std::uint64_t add(const Layer& layer, const PlanField& sides2, int first_node, TileSums::Layer& sums,
                      PlanField* tops) const {
        const auto radius = static_cast<float>(layer.radius);
        const auto straight = static_cast<float>(2 * layer.half_side);
        float least = std::numeric_limits<float>::max();
        float most = 0;
        for (const float side2 : sides2.v) {
            least = std::min(least, side2);
            most = std::max(most, side2);
        }
        const float reach = radius + static_cast<float>(kMostSwell);
        if (least >= reach * reach) return 0;
        PlanField held;
        const auto thicknessAt = [&](float swell) { sectionThickness(sides2, swell, radius, straight, held); };
        thicknessAt(0);
        addTo(held, -1, first_node, sums.surplus);
        if (tops != nullptr) addShared(layer, held, *tops, first_node, sums.surplus);
        // Flats all over gain nothing.
        if (!(most > 0)) return kAllPoints;
        std::uint64_t solid = 0;
        for (std::size_t c = 0; c < kColumnSamples; ++c) solid |= std::uint64_t{held.v[c] > 0} << c;
        const PlanField before = held;
        for (int level = 0; level < TileSums::kLevels; ++level) {
            thicknessAt(static_cast<float>(kMostSwell * (level + 1) / TileSums::kLevels));
            for (std::size_t c = 0; c < kColumnSamples; ++c) held.v[c] -= before.v[c];
            addTo(held, 1, first_node, sums.gain[static_cast<std::size_t>(level)]);
        }
        return solid;
    }

    // The area under those points.
    void addArea(std::uint64_t points, int first_node, TileSums::Nodes& nodes) const {
        if (points == 0) return;
        PlanField ones;
        for (std::size_t c = 0; c < kColumnSamples; ++c) ones.v[c] = points >> c & 1 ? 1.0F : 0.0F;
        addTo(ones, 1, first_node, nodes);
    }

    // What the crown takes from those points is left over.
    void addCrown(const Layer& layer, const PlanField& nearest, const PlanField& sides2, std::uint64_t points,
                  int first_node, TileSums::Nodes& surplus) const {
        const auto crown = static_cast<float>(layer.crown);
        const auto radius = static_cast<float>(layer.radius);
        const auto straight = static_cast<float>(layer.half_side);
        PlanField taken;
        for (std::size_t c = 0; c < kColumnSamples; ++c) {
            const float above = straight + std::sqrt(std::max(radius * radius - sides2.v[c], 0.0F));
            // The upper half loses no more than half of it: see PlaneTerm::rise.
            const float depth = std::min(crownDepth(crown, radius, nearest.v[c]), 0.5F * above);
            taken.v[c] = points >> c & 1 ? depth : 0.0F;
        }
        addTo(taken, 1, first_node, surplus);
    }

    static constexpr std::uint64_t kAllPoints = ~std::uint64_t{0};

private:
    void addShared(const Layer& layer, const PlanField& held, PlanField& tops, int first_node,
                   TileSums::Nodes& surplus) const {
        PlanField shared;
        bool any = false;
        for (std::size_t c = 0; c < kColumnSamples; ++c) {
            const auto center = static_cast<float>(layer.center_z);
            const float half = 0.5F * held.v[c];
            shared.v[c] = half > 0 ? std::clamp(tops.v[c] - (center - half), 0.0F, held.v[c]) : 0.0F;
            any |= shared.v[c] > 0;
            if (half > 0) tops.v[c] = std::max(tops.v[c], center + half);
        }
        if (any) addTo(shared, 1, first_node, surplus);
    }

    void addTo(const PlanField& held, float sign, int first_node, TileSums::Nodes& nodes) const {
        constexpr auto kArea =
            static_cast<float>(kColumnCells * kColumnCells * kNodeSpacing * kNodeSpacing / kColumnSamples);
        for (int node = 0; node < kColumnNodes * kColumnNodes; ++node) {
            // Eight sums side by side, which the compiler keeps in registers.
            float part[8] = {};
            const float* weight = weights_[static_cast<std::size_t>(node)].v;
            for (std::size_t c = 0; c < kColumnSamples; c += 8)
                for (std::size_t lane = 0; lane < 8; ++lane) part[lane] += weight[c + lane] * held.v[c + lane];
            const float sum = ((part[0] + part[1]) + (part[2] + part[3])) + ((part[4] + part[5]) + (part[6] + part[7]));
            const int place = first_node + node % kColumnNodes + node / kColumnNodes * kNodes;
            nodes[static_cast<std::size_t>(place)] += sign * kArea * sum;
        }
    }

    const ColumnGrid points_;
    const Weights weights_;
};

// Lays a bead's volume along its path, evenly over the width of a box of its height.
class Feeder {
public:
    Feeder(const gcode::Toolpath& toolpath, const LayerStack& stack, int x, int y)
        : toolpath_(toolpath), stack_(stack), first_x_(x * kTileCells), first_y_(y * kTileCells) {}

    void feed(std::uint32_t rank, TileSums::Layer& sums) const {
        const std::uint32_t index = stack_.beads[rank];
        const gcode::Bead& bead = toolpath_.beads[index];
        const double volume = gcode::laidVolume(toolpath_, index);
        const double height = 2 * stack_.layers[stack_.layer[rank]].halfHeight();
        const gcode::PlanPath path(toolpath_, bead);
        // A disc at a place is as long as it is wide.
        const double length =
            std::max(path.length(), std::min(std::sqrt(volume / height), static_cast<double>(bead.width)));
        if (!(volume > 0) || !(length > 0)) return;
        const double at_ends = feedEnds(index, volume, path, sums);
        const double along = volume - at_ends;
        const double width = along / (height * length);
        const int steps = std::max(static_cast<int>(std::ceil(length / kStep)), 1);
        const double part = along / (steps * kAcross);
        const auto [from, to] = stepsInTile(bead, length, width, steps);
        for (int n = from; n < to; ++n) {
            const Place place = placeAt(path, (n + 0.5) / steps, length);
            for (int m = 0; m < kAcross; ++m) {
                const double aside = ((m + 0.5) / kAcross - 0.5) * width;
                addPoint(place.x - aside * place.uy, place.y + aside * place.ux, part, sums.surplus);
            }
        }
    }

private:
    static constexpr double kStep = 0.5 * kNodeSpacing;
    static constexpr int kAcross = 4;
    struct Place {
        double x, y, ux, uy;
    };

    // Where the flow is simulated, the half discs at free ends are part of a bead's volume: lays them there, and
    // returns their volume.
    double feedEnds(std::uint32_t index, double volume, const gcode::PlanPath& path, TileSums::Layer& sums) const {
        const gcode::Bead& bead = toolpath_.beads[index];
        const double discs = volume - gcode::beadVolume(toolpath_, bead);
        if (toolpath_.flow.empty() || !(path.length() > 0) || !(discs > 0) || discs > 0.5 * volume) return 0;
        const auto meets = [](const gcode::Bead& a, const gcode::Bead& b) {
            constexpr double kSame = 1e-4;  // mm
            return std::hypot(double{a.x1} - double{b.x0}, double{a.y1} - double{b.y0}) < kSame && a.z1 == b.z0;
        };
        const bool free_start = index == 0 || !meets(toolpath_.beads[index - 1], bead);
        const bool free_end = index + 1 == toolpath_.beads.size() || !meets(bead, toolpath_.beads[index + 1]);
        const int ends = (free_start ? 1 : 0) + (free_end ? 1 : 0);
        if (ends == 0) return 0;
        const double width = static_cast<double>(bead.width);
        const double past = 2 * width / (3 * std::numbers::pi);  // the centroid of a half disc
        for (const bool at_end : {false, true}) {
            if (!(at_end ? free_end : free_start)) continue;
            const Place place = placeAt(path, at_end ? 1 : 0, 0);
            const double sign = at_end ? past : -past;
            for (int m = 0; m < kAcross; ++m) {
                const double aside = ((m + 0.5) / kAcross - 0.5) * 0.8 * width;
                addPoint(place.x + sign * place.ux - aside * place.uy, place.y + sign * place.uy + aside * place.ux,
                         discs / (ends * kAcross), sums.surplus);
            }
        }
        return discs;
    }

    // `length`: of the path, or of a disc at its place, in the direction of x.
    static Place placeAt(const gcode::PlanPath& path, double t, double length) {
        if (!(path.length() > 0)) {
            const gcode::PlanPoint at = path.at(0);
            return {at.x + (t - 0.5) * length, at.y, 1, 0};
        }
        const double mm = t * path.length();
        const gcode::PlanPoint at = path.at(mm);
        const gcode::PlanPoint along = path.direction(mm);
        return {at.x, at.y, along.x, along.y};
    }

    // Steps of a straight bead that may lay something in the tile; all of an arc.
    std::pair<int, int> stepsInTile(const gcode::Bead& bead, double length, double width, int steps) const {
        if (bead.arc >= 0) return {0, steps};
        double low = 0;
        double high = 1;
        const double more = width + length / steps;
        const auto clip = [&](double from, double to, int first) {
            const double least = first * kNodeSpacing - more;
            const double most = (first + kTileCells) * kNodeSpacing + more;
            if (std::abs(to - from) < more) return;
            const double a = (least - from) / (to - from);
            const double b = (most - from) / (to - from);
            low = std::max(low, std::min(a, b));
            high = std::min(high, std::max(a, b));
        };
        clip(bead.x0, bead.x1, first_x_);
        clip(bead.y0, bead.y1, first_y_);
        if (low >= high) return {0, 0};
        return {std::max(static_cast<int>(std::floor(low * steps)) - 1, 0),
                std::min(static_cast<int>(std::ceil(high * steps)) + 1, steps)};
    }

    // Each point lies in one cell of one tile.
    void addPoint(double x, double y, double volume, TileSums::Nodes& nodes) const {
        const double in_x = x / kNodeSpacing - first_x_;
        const double in_y = y / kNodeSpacing - first_y_;
        if (!(in_x >= 0 && in_x < kTileCells && in_y >= 0 && in_y < kTileCells)) return;
        const int i = static_cast<int>(in_x);
        const int j = static_cast<int>(in_y);
        const double fx = nodeShare(in_x - i);
        const double fy = nodeShare(in_y - j);
        const std::size_t at = nodeIndex(j, kNodes, i);
        nodes[at] += static_cast<float>(volume * (1 - fx) * (1 - fy));
        nodes[at + 1] += static_cast<float>(volume * fx * (1 - fy));
        nodes[at + kNodes] += static_cast<float>(volume * (1 - fx) * fy);
        nodes[at + kNodes + 1] += static_cast<float>(volume * fx * fy);
    }

    const gcode::Toolpath& toolpath_;
    const LayerStack& stack_;
    const int first_x_, first_y_;  // nodes
};

TileSums::Layer& sumsOf(Layers& layers, std::uint32_t layer) {
    std::unique_ptr<TileSums::Layer>& sums = layers[layer];
    if (sums == nullptr) sums = std::make_unique<TileSums::Layer>();
    return *sums;
}

// Whether some layer begins clearly below the top of another one before it.
bool layersOverlap(const LayerStack& stack) {
    double top = std::numeric_limits<double>::lowest();
    return std::any_of(stack.layers.begin(), stack.layers.end(), [&top](const Layer& layer) {
        const bool overlaps = layer.bottom() + 2 * kWeldGap * layer.halfHeight() < top;
        top = std::max(top, layer.center_z + layer.halfHeight());
        return overlaps;
    });
}

// Of a top in a column.
struct TopFields {
    TileSums::Layer* sums = nullptr;
    PlanField sides2, nearest;  // only with a crown
};

}  // namespace

Lattice cellLattice() {
    Lattice lattice;
    lattice.voxel_size = kColumnCells * kNodeSpacing / kLeafDim;
    lattice.half_width = 2;  // points lie up to a voxel beyond a leaf's outer samples
    return lattice;
}

TileSums sumTile(const gcode::Toolpath& toolpath, const LayerStack& stack, const PlanBins& bins, int x, int y) {
    static const ColumnSums kSums;
    const Lattice lattice = cellLattice();
    LeafColumn column(toolpath, stack, lattice, 1, LeafColumn::Kind::spread_without_swell);
    Layers layers;
    std::vector<std::uint32_t> ranks;
    std::vector<OpenTop> tops;
    std::vector<TopFields> fields;
    const bool overlap = layersOverlap(stack);
    PlanField highest;
    for (int cj = 0; cj < kTileColumns; ++cj)
        for (int ci = 0; ci < kTileColumns; ++ci) {
            const std::size_t bin = bins.find(x * kTileColumns + ci, y * kTileColumns + cj);
            if (bin == PlanBins::kNone) continue;
            ranks.insert(ranks.end(), bins[bin].begin(), bins[bin].end());
            column.open(bins.originI(bin), bins.originJ(bin), bins[bin], std::numeric_limits<std::uint32_t>::max());
            const int first_node = kColumnCells * (cj * kNodes + ci);
            if (overlap) std::fill(std::begin(highest.v), std::end(highest.v), std::numeric_limits<float>::lowest());
            tops.clear();
            fields.clear();
            column.forEachSides([&](std::uint32_t layer, const PlanField& sides2, const PlanField& nearest) {
                const Layer& of = stack.layers[layer];
                TileSums::Layer& sums = sumsOf(layers, layer);
                const std::uint64_t solid = kSums.add(of, sides2, first_node, sums, overlap ? &highest : nullptr);
                if (solid == 0) return;
                addTop(layer, solid, tops);
                TopFields& top = fields.emplace_back();
                top.sums = &sums;
                if (!(of.crown > 0)) return;
                kSums.addArea(solid, first_node, sums.solid);
                top.sides2 = sides2;
                top.nearest = nearest;
            });
            coverTops(stack, tops);
            for (std::size_t n = 0; n < tops.size(); ++n) {
                const TopFields& top = fields[n];
                kSums.addArea(tops[n].open, first_node, top.sums->open);
                const Layer& of = stack.layers[tops[n].layer];
                if (of.crown > 0 && tops[n].open != 0)
                    kSums.addCrown(of, top.nearest, top.sides2, tops[n].open, first_node, top.sums->surplus);
            }
        }
    std::sort(ranks.begin(), ranks.end());
    ranks.erase(std::unique(ranks.begin(), ranks.end()), ranks.end());
    const Feeder feeder(toolpath, stack, x, y);
    for (const std::uint32_t rank : ranks)
        if (rank < stack.first_direct) feeder.feed(rank, sumsOf(layers, stack.layer[rank]));
    TileSums tile;
    for (auto& [layer, sums] : layers) {
        tile.layers.push_back(layer);
        tile.sums.push_back(std::move(sums));
    }
    return tile;
}

}  // namespace stratum::voxelize
