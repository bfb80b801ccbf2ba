#include "voxelize/swell/tile_sums.h"

#include "voxelize/leaf/leaf_column.h"
#include "voxelize/swell/node_sums.h"
#include "voxelize/swell/open_top.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <utility>

namespace stratum::voxelize {
namespace {

constexpr int kNodes = TileSums::kNodes;
constexpr int kTileColumns = kTileCells / kSquareCells;

using Layers = std::map<std::uint32_t, std::unique_ptr<TileSums::Layer>>;

// The points of a column of cellLattice(), from the middle of its square.
ColumnGrid pointsOfSquare() {
    const auto voxel = static_cast<float>(cellLattice().voxel_size);
    ColumnGrid points = ColumnGrid::spread(voxel);
    // The column has its middle between its samples.
    for (std::size_t c = 0; c < kColumnSamples; ++c) {
        points.qx.v[c] -= 0.5F * voxel;
        points.qy.v[c] -= 0.5F * voxel;
    }
    return points;
}

// What a column's layers hold and gain, added to the nodes of its square.
class ColumnSums {
public:
    ColumnSums() : nodes_(pointsOfSquare()) {}

    // Returns the points with plastic, bit c for point c.
    // `tops`: if not null, the highest plastic of the layers below at each point, mm: what this layer shares with them
    // it does not hold. The layer's own is added.
    std::uint64_t add(const Layer& layer, const PlanField& sides2, int first_node, TileSums::Layer& sums,
                      PlanField* tops) const {
        thread_local PressedLayer pressed;
        const auto radius = static_cast<float>(layer.radius);
        const auto straight = static_cast<float>(2 * layer.half_side);
        pressLayer(sides2, radius, straight, pressed);
        if (pressed.kind == PressedLayer::Kind::nothing) return 0;
        if (pressed.kind == PressedLayer::Kind::flat) {
            const float held = straight + 2 * radius;
            if (tops == nullptr) {
                addFlat(-held, first_node, sums.surplus);
                return kAllPoints;
            }
            for (PlanField& gain : pressed.fields) gain = {};
            std::fill(std::begin(pressed.fields[0].v), std::end(pressed.fields[0].v), held);
            pressed.solid = kAllPoints;
        }
        if (tops != nullptr) takeShared(layer, pressed.fields[0], *tops);
        const NodeSums::Sums by_node = nodes_.of(pressed.fields);
        for (std::size_t node = 0; node < NodeSums::kNodes; ++node) {
            const std::size_t place = placeOf(first_node, node);
            sums.surplus[place] -= by_node[node][0];
            for (std::size_t level = 0; level < sums.gain.size(); ++level)
                sums.gain[level][place] += by_node[node][1 + level];
        }
        return pressed.solid;
    }

    // The area of a top, with `solid` points of which `open` have nothing on them. Of one with a crown, also that of
    // its plastic, and what the crown takes is left over. `nearest`, `sides2`: used only then.
    void addTop(const Layer& layer, std::uint64_t solid, std::uint64_t open, const PlanField& nearest,
                const PlanField& sides2, int first_node, TileSums::Layer& sums) const {
        const bool crowned = layer.crown > 0;
        if (!crowned && open == 0) return;
        if (!crowned && open == kAllPoints) return addFlat(1, first_node, sums.open);
        if (crowned && open == 0 && solid == kAllPoints) return addFlat(1, first_node, sums.solid);
        thread_local std::array<PlanField, NodeSums::kFields> fields;
        const auto ones = [this](std::uint64_t points, PlanField& field) {
            for (std::size_t c = 0; c < kColumnSamples; c += 8)
                std::copy_n(ones_[points >> c & 0xff].data(), 8, field.v + c);
        };
        ones(open, fields[0]);
        ones(crowned ? solid : 0, fields[1]);
        if (crowned && open != 0)
            crownTakes(layer, nearest, sides2, fields[0], fields[2]);
        else
            fields[2] = {};
        const NodeSums::Sums by_node = nodes_.of(fields);
        for (std::size_t node = 0; node < NodeSums::kNodes; ++node) {
            const std::size_t place = placeOf(first_node, node);
            sums.open[place] += by_node[node][0];
            sums.solid[place] += by_node[node][1];
            sums.surplus[place] += by_node[node][2];
        }
    }

private:
    static constexpr std::uint64_t kAllPoints = ~std::uint64_t{0};

    static std::size_t placeOf(int first_node, std::size_t node) {
        constexpr auto kSide = static_cast<std::size_t>(kSquareNodes);
        constexpr auto kRow = static_cast<std::size_t>(kNodes);
        return static_cast<std::size_t>(first_node) + node % kSide + node / kSide * kRow;
    }

    void addFlat(float height, int first_node, TileSums::Nodes& nodes) const {
        for (std::size_t node = 0; node < NodeSums::kNodes; ++node)
            nodes[placeOf(first_node, node)] += height * nodes_.area(node);
    }

    static void takeShared(const Layer& layer, PlanField& held, PlanField& tops) {
        const auto center = static_cast<float>(layer.center_z);
        for (std::size_t c = 0; c < kColumnSamples; ++c) {
            const float half = 0.5F * held.v[c];
            if (!(half > 0)) continue;
            held.v[c] -= std::clamp(tops.v[c] - (center - half), 0.0F, held.v[c]);
            tops.v[c] = std::max(tops.v[c], center + half);
        }
    }

    // `open`: 1 where the top is.
    static void crownTakes(const Layer& layer, const PlanField& nearest, const PlanField& sides2, const PlanField& open,
                           PlanField& taken) {
        const auto crown = static_cast<float>(layer.crown);
        const auto radius = static_cast<float>(layer.radius);
        const auto straight = static_cast<float>(layer.half_side);
        for (std::size_t c = 0; c < kColumnSamples; ++c) {
            const float above = straight + std::sqrt(std::max(radius * radius - sides2.v[c], 0.0F));
            // The upper half loses no more than half of it: see PlaneTerm::rise.
            taken.v[c] = open.v[c] * std::min(crownDepth(crown, radius, nearest.v[c]), 0.5F * above);
        }
    }

    // Of each byte its bits, from the lowest, as numbers.
    static std::array<std::array<float, 8>, 256> onesOfBytes() {
        std::array<std::array<float, 8>, 256> ones;
        for (std::size_t byte = 0; byte < ones.size(); ++byte)
            for (std::size_t bit = 0; bit < 8; ++bit) ones[byte][bit] = static_cast<float>(byte >> bit & 1);
        return ones;
    }

    const NodeSums nodes_;
    const std::array<std::array<float, 8>, 256> ones_ = onesOfBytes();
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

// Layers that reach into each other, such as threads of bridges and what they lie on. Most reach into none.
class LayerOverlaps {
public:
    explicit LayerOverlaps(const LayerStack& stack) : takes_(stack.layers.size()), gives_(stack.layers.size()) {
        double top = std::numeric_limits<double>::lowest();
        for (std::size_t n = 0; n < takes_.size(); ++n) {
            const Layer& layer = stack.layers[n];
            takes_[n] = layer.bottom() + 2 * kWeldGap * layer.halfHeight() < top;
            top = std::max(top, topOf(layer));
            any_ = any_ || takes_[n];
        }
        double bottom = std::numeric_limits<double>::max();
        for (std::size_t n = takes_.size(); n-- > 0;) {
            gives_[n] = topOf(stack.layers[n]) > bottom;
            if (takes_[n]) bottom = std::min(bottom, stack.layers[n].bottom());
        }
    }
    bool any() const { return any_; }
    // Whether a layer begins clearly below the top of one before it.
    bool takes(std::uint32_t layer) const { return takes_[layer]; }
    // Whether one behind it that takes begins below its top.
    bool gives(std::uint32_t layer) const { return gives_[layer]; }

private:
    // Before it is raised.
    static double topOf(const Layer& layer) { return layer.center_z + layer.halfHeight(); }

    std::vector<bool> takes_, gives_;
    bool any_ = false;
};

// Of a top in a column, in the order of the tops.
struct TopFields {
    TileSums::Layer* sums = nullptr;
    std::uint64_t solid = 0;
    PlanField sides2, nearest;  // only with a crown
};

}  // namespace

Lattice cellLattice() {
    Lattice lattice;
    lattice.voxel_size = kSquareCells * kNodeSpacing / kLeafDim;
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
    const LayerOverlaps overlaps(stack);
    PlanField highest;
    for (int cj = 0; cj < kTileColumns; ++cj)
        for (int ci = 0; ci < kTileColumns; ++ci) {
            const std::size_t bin = bins.find(x * kTileColumns + ci, y * kTileColumns + cj);
            if (bin == PlanBins::kNone) continue;
            ranks.insert(ranks.end(), bins[bin].begin(), bins[bin].end());
            column.open(bins.originI(bin), bins.originJ(bin), bins[bin], std::numeric_limits<std::uint32_t>::max());
            const int first_node = kSquareCells * (cj * kNodes + ci);
            if (overlaps.any())
                std::fill(std::begin(highest.v), std::end(highest.v), std::numeric_limits<float>::lowest());
            tops.clear();
            column.forEachSides([&](std::uint32_t layer, const PlanField& sides2, const PlanField& nearest) {
                const Layer& of = stack.layers[layer];
                TileSums::Layer& sums = sumsOf(layers, layer);
                PlanField* const tops_below = overlaps.takes(layer) || overlaps.gives(layer) ? &highest : nullptr;
                const std::uint64_t solid = kSums.add(of, sides2, first_node, sums, tops_below);
                if (solid == 0) return;
                addTop(layer, solid, tops);
                if (tops.size() > fields.size()) fields.emplace_back();
                TopFields& top = fields[tops.size() - 1];
                top.sums = &sums;
                top.solid = solid;
                if (!(of.crown > 0)) return;
                top.sides2 = sides2;
                top.nearest = nearest;
            });
            coverTops(stack, tops);
            for (std::size_t n = 0; n < tops.size(); ++n) {
                const TopFields& top = fields[n];
                kSums.addTop(stack.layers[tops[n].layer], top.solid, tops[n].open, top.nearest, top.sides2, first_node,
                             *top.sums);
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
