#include "voxelize/swell/tile_sums.h"

#include "voxelize/leaf/leaf_column.h"
#include "voxelize/swell/fed_volume.h"
#include "voxelize/swell/layer_needs.h"
#include "voxelize/swell/node_sums.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace stratum::voxelize {
namespace {

constexpr int kNodes = TileSums::kNodes;
constexpr int kSumColumns = kSumCells / kSquareCells;

constexpr std::size_t kRow = std::size_t{kNodes} * NodeSums::kFields;  // values
static_assert(sizeof(TileSums::Node) == NodeSums::kFields * sizeof(float));

// A layer of TileSums at work: all nodes.
struct WholeLayer {
    std::array<TileSums::Node, std::size_t{kNodes} * kNodes> nodes{};
    std::array<float, std::size_t{kNodes} * kNodes> open{}, solid{};
    bool used = false, any_open = false, any_solid = false;
};

// The points of a column of cellLattice(1), from the middle of its square.
ColumnGrid pointsOfSquare() {
    const auto voxel = static_cast<float>(cellLattice(1).voxel_size);
    ColumnGrid points = ColumnGrid::spread(voxel);
    // The column has its middle between its samples.
    for (std::size_t c = 0; c < kColumnSamples; ++c) {
        points.qx.v[c] -= 0.5F * voxel;
        points.qy.v[c] -= 0.5F * voxel;
    }
    return points;
}

// Of the top of a layer with a crown.
struct TopFields {
    PlanField sides2, nearest;
};

// What a column's layers hold and gain, added to the nodes of its square.
class ColumnSums {
public:
    explicit ColumnSums(double settling_scale) : settling_scale_(settling_scale) {}

    // Returns the points with plastic, bit c for point c.
    // `tops`: if not null, the highest plastic of the layers below at each point, mm: what this layer shares with them
    // it does not hold. The layer's own is added. `direct`: likewise, if not null. `sums`: null for a layer of another
    // tile.
    std::uint64_t add(const Layer& layer, const PlanField& sides2, int first_node, WholeLayer* sums, PlanField* tops,
                      const DirectOverlap* direct) const {
        thread_local PressedLayer pressed;
        PlanField shared_with_direct;
        const auto radius = static_cast<float>(layer.radius);
        const auto straight = static_cast<float>(2 * layer.half_side);
        pressLayer(sides2, radius, straight, settling_scale_, pressed);
        if (pressed.kind == PressedLayer::Kind::nothing) return 0;
        if (pressed.kind == PressedLayer::Kind::flat) {
            pressed.solid = kAllPoints;
            const float held = straight + 2 * radius;
            if (tops == nullptr && direct == nullptr) {
                if (sums != nullptr)
                    addFlat(
                        first_node, [&](std::size_t node) -> float& { return sums->nodes[node].surplus; }, -held);
                return kAllPoints;
            }
            for (PlanField& gain : pressed.fields) gain = {};
            std::fill(std::begin(pressed.fields[0].v), std::end(pressed.fields[0].v), -held);
        }
        if (direct != nullptr) direct->share(layer, pressed.fields, shared_with_direct);
        if (tops != nullptr) takeShared(layer, pressed.fields[0], *tops);
        if (direct != nullptr)
            for (std::size_t c = 0; c < kColumnSamples; ++c)
                pressed.fields[0].v[c] = std::min(pressed.fields[0].v[c] + shared_with_direct.v[c], 0.0F);
        if (sums != nullptr)
            nodes_.add(pressed.fields, &sums->nodes[static_cast<std::size_t>(first_node)].surplus, kRow);
        return pressed.solid;
    }

    // The area of a top, with `solid` points of which `open` have nothing on them. Of one with a crown, also that of
    // its plastic, and what the crown takes is left over. `crown`: null without one.
    void addTop(const Layer& layer, std::uint64_t solid, std::uint64_t open, const TopFields* crown, int first_node,
                WholeLayer& sums) const {
        const bool crowned = crown != nullptr;
        if (!crowned && open == 0) return;
        sums.any_open |= open != 0;
        sums.any_solid |= crowned;
        const auto addOnes = [&](auto& values) {
            addFlat(
                first_node, [&](std::size_t node) -> float& { return values[node]; }, 1);
        };
        if (!crowned && open == kAllPoints) return addOnes(sums.open);
        if (crowned && open == 0 && solid == kAllPoints) return addOnes(sums.solid);
        thread_local std::array<PlanField, NodeSums::kFields> fields;
        const auto ones = [this](std::uint64_t points, PlanField& field) {
            for (std::size_t c = 0; c < kColumnSamples; c += 8)
                std::copy_n(ones_[points >> c & 0xff].data(), 8, field.v + c);
        };
        ones(open, fields[0]);
        ones(crowned ? solid : 0, fields[1]);
        if (crowned && open != 0)
            crownTakes(layer, *crown, fields[0], fields[2]);
        else
            fields[2] = {};
        const NodeSums::Sums by_node = nodes_.of(fields);
        for (std::size_t node = 0; node < NodeSums::kNodes; ++node) {
            const std::size_t place = placeOf(first_node, node);
            sums.open[place] += by_node[node][0];
            sums.solid[place] += by_node[node][1];
            sums.nodes[place].surplus += by_node[node][2];
        }
    }

private:
    static constexpr std::uint64_t kAllPoints = ~std::uint64_t{0};

    static std::size_t placeOf(int first_node, std::size_t node) {
        constexpr auto kSide = static_cast<std::size_t>(kSquareNodes);
        constexpr auto kRow = static_cast<std::size_t>(kNodes);
        return static_cast<std::size_t>(first_node) + node % kSide + node / kSide * kRow;
    }

    template <typename ValueOf>
    void addFlat(int first_node, const ValueOf& value_of, float height) const {
        for (std::size_t node = 0; node < NodeSums::kNodes; ++node)
            value_of(placeOf(first_node, node)) += height * nodes_.area(node);
    }

    // `lost`: what the layer holds, below 0.
    static void takeShared(const Layer& layer, PlanField& lost, PlanField& tops) {
        const auto center = static_cast<float>(layer.center_z);
        for (std::size_t c = 0; c < kColumnSamples; ++c) {
            const float held = -lost.v[c];
            const float half = 0.5F * held;
            if (!(half > 0)) continue;
            lost.v[c] += std::clamp(tops.v[c] - (center - half), 0.0F, held);
            tops.v[c] = std::max(tops.v[c], center + half);
        }
    }

    // `open`: 1 where the top is.
    static void crownTakes(const Layer& layer, const TopFields& top, const PlanField& open, PlanField& taken) {
        const auto crown = static_cast<float>(layer.crown);
        const auto radius = static_cast<float>(layer.radius);
        const auto straight = static_cast<float>(layer.half_side);
        for (std::size_t c = 0; c < kColumnSamples; ++c) {
            const float above = straight + std::sqrt(std::max(radius * radius - top.sides2.v[c], 0.0F));
            // The upper half loses no more than half of it: see PlaneTerm::rise.
            taken.v[c] = open.v[c] * std::min(crownDepth(crown, radius, top.nearest.v[c]), 0.5F * above);
        }
    }

    // Of each byte its bits, from the lowest, as numbers.
    static std::array<std::array<float, 8>, 256> onesOfBytes() {
        std::array<std::array<float, 8>, 256> ones;
        for (std::size_t byte = 0; byte < ones.size(); ++byte)
            for (std::size_t bit = 0; bit < 8; ++bit) ones[byte][bit] = static_cast<float>(byte >> bit & 1);
        return ones;
    }

    static const NodeSums& nodesOfSquare() {
        static const NodeSums kNodeSums(pointsOfSquare());
        return kNodeSums;
    }
    using Ones = std::array<std::array<float, 8>, 256>;
    static const Ones& onesOfAllBytes() {
        static const Ones kOnes = onesOfBytes();
        return kOnes;
    }

    const double settling_scale_;
    const NodeSums& nodes_ = nodesOfSquare();
    const Ones& ones_ = onesOfAllBytes();
};

// Of the nodes that are not 0.
NodeBox boxOf(const WholeLayer& sums) {
    NodeBox box;
    for (int row = 0; row < kNodes; ++row) {
        int first = kNodes;
        int last = -1;
        for (int column = 0; column < kNodes; ++column) {
            const std::size_t n = nodeIndex(row, kNodes, column);
            // All but the surplus are 0 or more.
            const float sum =
                std::abs(sums.nodes[n].surplus) + sums.nodes[n].gain.back() + sums.open[n] + sums.solid[n];
            if (!(sum > 0)) continue;
            first = std::min(first, column);
            last = column;
        }
        if (last >= 0) box = box.with({first, last + 1, row, row + 1});
    }
    return box;
}

// What is not 0 of it.
std::unique_ptr<TileSums::Layer> keep(const WholeLayer& sums) {
    auto kept = std::make_unique<TileSums::Layer>();
    const NodeBox box = kept->box = boxOf(sums);
    if (box.empty()) return nullptr;
    const auto copy = [&box](const auto& from, auto& to) {
        to.reserve(static_cast<std::size_t>(box.x1 - box.x0) * static_cast<std::size_t>(box.y1 - box.y0));
        for (int row = box.y0; row < box.y1; ++row) {
            const auto first = from.begin() + static_cast<std::ptrdiff_t>(nodeIndex(row, kNodes, 0));
            to.insert(to.end(), first + box.x0, first + box.x1);
        }
    };
    copy(sums.nodes, kept->nodes);
    if (sums.any_open) copy(sums.open, kept->open);
    if (sums.any_solid) copy(sums.solid, kept->solid);
    return kept;
}

// Ranks of a range: each once, whatever was added how often.
class RankSet {
public:
    RankSet(std::uint32_t first, std::uint32_t last) : first_(first), words_((last - first + 63) / 64) {}

    void add(std::span<const std::uint32_t> ranks) {
        for (const std::uint32_t rank : ranks) words_[(rank - first_) / 64] |= std::uint64_t{1} << (rank - first_) % 64;
    }
    // In ascending order.
    template <typename Visit>
    void forEach(Visit visit) const {
        for (std::size_t n = 0; n < words_.size(); ++n)
            for (std::uint64_t left = words_[n]; left != 0; left &= left - 1)
                visit(first_ + static_cast<std::uint32_t>(64 * n) + static_cast<std::uint32_t>(std::countr_zero(left)));
    }

private:
    const std::uint32_t first_;
    std::vector<std::uint64_t> words_;
};

// Which layers the sums of a tile are made of, and the ranks of their beads. Of one tile.
class TileLayers {
public:
    TileLayers(const LayerStack& stack, const LayerNeeds& needs, TilePlace place)
        : stack_(stack),
          others_(needs.ofOthers(place.z)),
          first_(place.firstLayer()),
          last_(static_cast<std::uint32_t>(std::min<std::size_t>(first_ + kTileLayers, stack.layers.size()))) {}

    bool owns(std::uint32_t layer) const { return layer >= first_ && layer < last_; }
    // mm, of the tile's own layers.
    double bottom() const {
        double bottom = std::numeric_limits<double>::max();
        for (std::uint32_t n = first_; n < last_; ++n) bottom = std::min(bottom, stack_.layers[n].bottom());
        return bottom;
    }
    double top() const {
        double top = std::numeric_limits<double>::lowest();
        for (std::uint32_t n = first_; n < last_; ++n) top = std::max(top, stack_.layers[n].top());
        return top;
    }
    std::uint32_t firstRank() const { return stack_.layers[first_].first; }
    std::uint32_t lastRank() const { return stack_.layers[last_ - 1].last; }
    bool needs(std::uint32_t layer) const {
        return owns(layer) || std::binary_search(others_.begin(), others_.end(), layer);
    }
    // Of a column's ranks those of the tile's own layers; ranks ascend with their layers.
    std::span<const std::uint32_t> ownOf(std::span<const std::uint32_t> ranks) const {
        const auto first = firstNotBelow(ranks, firstRank(), stack_.beads.size());
        const auto from = ranks.begin() + static_cast<std::ptrdiff_t>(first);
        auto to = from;
        while (to != ranks.end() && *to < lastRank()) ++to;
        return {from, to};
    }
    // Of all layers that are needed; some between them may not be. `own`: of ownOf().
    std::span<const std::uint32_t> neededOf(std::span<const std::uint32_t> ranks,
                                            std::span<const std::uint32_t> own) const {
        if (others_.empty()) return own;
        std::size_t first = static_cast<std::size_t>(own.data() - ranks.data());
        std::size_t last = first + own.size();
        while (first > 0 && ranks[first - 1] >= stack_.layers[others_.front()].first) --first;
        while (last < ranks.size() && ranks[last] < stack_.layers[others_.back()].last) ++last;
        return ranks.subspan(first, last - first);
    }

private:
    const LayerStack& stack_;
    const std::span<const std::uint32_t> others_;
    const std::uint32_t first_, last_;
};

}  // namespace

Lattice cellLattice(double settling_scale) {
    Lattice lattice;
    lattice.voxel_size = kSquareCells * kNodeSpacing * settling_scale / kLeafDim;
    lattice.half_width = 2;  // points lie up to a voxel beyond a leaf's outer samples
    return lattice;
}

TileSums sumTile(const gcode::Toolpath& toolpath, const LayerStack& stack, const LayerNeeds& needs,
                 const PlanBins& bins, TilePlace place) {
    const Lattice lattice = cellLattice(stack.settling_scale);
    const TileLayers own(stack, needs, place);
    const ColumnSums column_sums(stack.settling_scale);
    LeafColumn column(toolpath, stack, lattice, 1, LeafColumn::Kind::spread_without_swell);
    DirectOverlap direct(toolpath, stack, own.bottom(), own.top());
    thread_local std::array<WholeLayer, kTileLayers> whole;
    const auto sumsOf = [](std::uint32_t layer) -> WholeLayer& {
        WholeLayer& sums = whole[layer % kTileLayers];
        if (!sums.used) sums = {};
        sums.used = true;
        return sums;
    };
    for (WholeLayer& sums : whole) sums.used = false;
    RankSet own_ranks(own.firstRank(), own.lastRank());
    std::vector<OpenTop> tops;
    std::vector<TopFields> fields;  // of tops, where they have crowns
    PlanField highest;
    for (int cj = 0; cj < kSumColumns; ++cj)
        for (int ci = 0; ci < kSumColumns; ++ci) {
            const std::size_t bin = bins.find(place.x * kSumColumns + ci, place.y * kSumColumns + cj);
            if (bin == PlanBins::kNone) continue;
            const std::span<const std::uint32_t> near = own.ownOf(bins[bin]);
            if (near.empty()) continue;
            own_ranks.add(near);
            column.open(bins.originI(bin), bins.originJ(bin), own.neededOf(bins[bin], near),
                        std::numeric_limits<std::uint32_t>::max());
            direct.gather(column, bins[bin]);
            const int first_node = kSquareCells * (cj * kNodes + ci);
            if (needs.anyOverlap())
                std::fill(std::begin(highest.v), std::end(highest.v), std::numeric_limits<float>::lowest());
            tops.clear();
            const auto needed = [&own](std::uint32_t layer) { return own.needs(layer); };
            column.forEachSides(needed, [&](std::uint32_t layer, const PlanField& sides2, const PlanField& nearest) {
                const Layer& of = stack.layers[layer];
                WholeLayer* const sums = own.owns(layer) ? &sumsOf(layer) : nullptr;
                PlanField* const tops_below = needs.takes(layer) || needs.gives(layer) ? &highest : nullptr;
                const DirectOverlap* const met = sums != nullptr && direct.meets(of) ? &direct : nullptr;
                const std::uint64_t solid = column_sums.add(of, sides2, first_node, sums, tops_below, met);
                if (solid == 0) return;
                addTop(layer, solid, tops);
                if (sums == nullptr || !(of.crown > 0)) return;
                if (tops.size() > fields.size()) fields.resize(tops.size());
                fields[tops.size() - 1] = {sides2, nearest};
            });
            coverTops(stack, tops);
            for (std::size_t n = 0; n < tops.size(); ++n) {
                const OpenTop& top = tops[n];
                if (!own.owns(top.layer)) continue;
                const Layer& of = stack.layers[top.layer];
                column_sums.addTop(of, top.solid, top.open, of.crown > 0 ? &fields[n] : nullptr, first_node,
                                   sumsOf(top.layer));
            }
        }
    const FedVolume fed(toolpath, stack, place);
    own_ranks.forEach([&](std::uint32_t rank) { fed.feed(rank, sumsOf(stack.layer[rank]).nodes); });
    TileSums tile;
    for (std::size_t n = 0; n < whole.size(); ++n)
        if (whole[n].used) tile.layers[n] = keep(whole[n]);
    return tile;
}

}  // namespace stratum::voxelize
