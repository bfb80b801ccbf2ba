#include "voxelize/swell/tile_spread.h"

#include "voxelize/swell/node_sums.h"
#include "voxelize/swell/spread.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

namespace stratum::voxelize {
namespace {

constexpr int kSpreadEdge = kTileCells + 2 * kSpreadHalo;

// The nodes of a tile and the halo around it, of one layer. `nodes`: 0 before. Returns a box of those that are not 0.
NodeBox gather(const SumsAround& around, std::uint32_t layer, SpreadNodes& nodes) {
    static_assert(kSpreadHalo <= kSumCells);
    NodeBox all;
    for (int tile = 0; tile < SumsAround::kCount; ++tile) {
        const TileSums::Layer* sums = around.tiles[static_cast<std::size_t>(tile)]->of(layer);
        if (sums == nullptr) continue;
        const int to_x = (tile % SumsAround::kEdge - 1) * kSumCells + kSpreadHalo;
        const int to_y = (tile / SumsAround::kEdge - 1) * kSumCells + kSpreadHalo;
        const NodeBox box = sums->box.moved(to_x, to_y).within(NodeBox::all(nodes.edge));
        if (box.empty()) continue;
        all = all.with(box);
        const auto count = static_cast<std::size_t>(box.x1 - box.x0);
        for (int j = box.y0; j < box.y1; ++j) {
            const std::size_t from = sums->placeOf(j - to_y, box.x0 - to_x);
            const std::size_t to = nodeIndex(j, nodes.edge, box.x0);
            addNodes(std::span(sums->nodes).subspan(from, count), nodes.surplus.data() + to, nodes.gain[0].data() + to,
                     nodes.gain[1].data() + to, nodes.gain[2].data() + to);
            if (sums->open.empty()) continue;
            float* const open = nodes.open.data() + to;
            for (std::size_t i = 0; i < count; ++i) open[i] += sums->open[from + i];
        }
    }
    return all;
}

// The room in which a tile is spread, kept by each thread.
struct SpreadRoom {
    SpreadNodes nodes{kSpreadEdge};
    Spreading spreading{kSpreadEdge};
    NodeBox used;  // of the nodes

    void clear() {
        nodes.clear(used);
        used = {};
    }
};

SpreadRoom& roomOfThread() {
    thread_local SpreadRoom room;
    return room;
}

// Spreads the surplus of a tile's layers, from kUpLayers below: what has no place in one may find it in the next.
class TileSpread {
public:
    // `below`: the sums around the tile below, if there is one.
    TileSpread(const LayerStack& stack, TilePlace place, const SumsAround& around, const SumsAround* below)
        : stack_(stack), own_from_(place.firstLayer()), around_(around), below_(below) {}

    SwellTile spread() {
        if (below_ != nullptr)
            for (std::uint32_t n = own_from_ - kUpLayers; n < own_from_; ++n) spreadLayer(n, *below_);
        const auto count = static_cast<std::uint32_t>(stack_.layers.size());
        for (std::uint32_t n = own_from_; n < std::min(own_from_ + kTileLayers, count); ++n) spreadLayer(n, around_);
        return {out_.arranged(), rise_.arranged(), open_.arranged()};
    }

private:
    // mm^3 by how many layers below the plastic was laid.
    using Volumes = std::array<double, kUpLayers + 1>;
    struct NodeVolumes {
        std::size_t node = 0;  // of those that the tile owns
        Volumes volumes{};
    };
    using AllVolumes = std::vector<NodeVolumes>;  // nodes ascend; of the others nothing is left

    // The values of layers, from the lowest.
    struct Values {
        std::vector<std::uint32_t> layers;
        std::vector<float> values;

        void set(std::uint32_t layer, std::size_t node, double value) {
            if (!(value > 0)) return;
            if (layers.empty() || layers.back() != layer) {
                layers.push_back(layer);
                values.resize(values.size() + NodeValues::kNodes, 0.0F);
            }
            values[values.size() - NodeValues::kNodes + node] = static_cast<float>(value);
        }
        NodeValues arranged() const { return {layers, values}; }
    };

    void spreadLayer(std::uint32_t layer, const SumsAround& around) {
        if (!reaches(around, layer)) return;
        const Layer& of = stack_.layers[layer];
        const bool own = layer >= own_from_;
        room_.clear();
        room_.used = gather(around, layer, room_.nodes);
        const SpreadNodes& nodes = room_.nodes;
        constexpr NodeBox kOwn{kSpreadHalo, kSpreadHalo + kTileCells, kSpreadHalo, kSpreadHalo + kTileCells};
        const Spread& spread = room_.spreading.spread(nodes, room_.used, kOwn, of.most_rise);
        const AllVolumes from_below = takeFromBelow(layer);
        auto next_below = from_below.begin();
        AllVolumes goes_on;
        const NodeBox box = from_below.empty() ? kOwn.within(room_.used) : kOwn;
        for (int j = box.y0; j < box.y1; ++j)
            for (int i = box.x0; i < box.x1; ++i) {
                const std::size_t n = nodeIndex(j, kSpreadEdge, i);
                const std::size_t at = nodeIndex(j - kSpreadHalo, kTileCells, i - kSpreadHalo);
                // What comes from below takes what room the layer's own surplus has left, and the rest goes on.
                Volumes volumes{};
                double below = 0;
                if (next_below != from_below.end() && next_below->node == at) {
                    volumes = next_below->volumes;
                    for (const double volume : volumes) below += volume;
                    ++next_below;
                }
                double moves_up = std::max(static_cast<double>(spread.left[n]) + below, 0.0);
                const auto open = static_cast<double>(nodes.open[n]);
                const bool crowned = open > 0 && of.crown > 0;
                if (!(moves_up > 0 || spread.given[n] > 0 || spread.raised[n] > 0 || crowned)) continue;
                const auto place = [&moves_up](float already, double most) {
                    const double more = std::clamp(most - static_cast<double>(already), 0.0, moves_up);
                    moves_up -= more;
                    return static_cast<double>(already) + more;
                };
                const double given = place(spread.given[n], static_cast<double>(nodes.gain.back()[n]));
                const double raised = place(spread.raised[n], open * of.most_rise);
                if (moves_up > 0) {
                    volumes[0] = std::max(static_cast<double>(spread.left[n]), 0.0);
                    keepFarthest(moves_up, volumes);
                    goes_on.push_back({at, volumes});
                }
                if (!own) continue;
                out_.set(layer, at, swellThatGains(nodes, n, given) * stack_.settling_scale);
                if (!(open > 0)) continue;
                rise_.set(layer, at, std::min(raised / open, of.most_rise));
                if (crowned) open_.set(layer, at, openShare(layer, at, open));
            }
        up_[layer + kUpLayers - own_from_] = std::move(goes_on);
    }

    // Of what is at a node, that from the nearest layers has found a place first: what lies farther below has no
    // influence on it, so it does not matter at which layer one begins.
    static void keepFarthest(double left, Volumes& volumes) {
        for (std::size_t n = volumes.size(); n-- > 0;) {
            volumes[n] = std::min(volumes[n], left);
            left -= volumes[n];
        }
    }

    // What the layers on which this one lies have left at each node, if it was laid near enough.
    AllVolumes takeFromBelow(std::uint32_t layer) {
        AllVolumes sum;
        const auto first = std::lower_bound(stack_.welds.begin(), stack_.welds.end(), layer,
                                            [](const Weld& weld, std::uint32_t upper) { return weld.upper < upper; });
        for (auto weld = first; weld != stack_.welds.end() && weld->upper == layer; ++weld) {
            const std::uint32_t up = layer - weld->lower;
            if (up > kUpLayers || weld->lower + kUpLayers < own_from_) continue;
            // Another layer that lies on the same one finds nothing.
            AllVolumes left = std::exchange(up_[weld->lower + kUpLayers - own_from_], {});
            for (NodeVolumes& of : left) {
                std::move_backward(of.volumes.begin(), of.volumes.end() - up, of.volumes.end());
                std::fill_n(of.volumes.begin(), up, 0.0);
            }
            sum = sum.empty() ? std::move(left) : sumOf(sum, left);
        }
        return sum;
    }

    static AllVolumes sumOf(const AllVolumes& a, const AllVolumes& b) {
        AllVolumes sum;
        auto in_a = a.begin();
        for (const NodeVolumes& of : b) {
            while (in_a != a.end() && in_a->node < of.node) sum.push_back(*in_a++);
            sum.push_back(of);
            if (in_a == a.end() || in_a->node != of.node) continue;
            for (std::size_t n = 0; n < of.volumes.size(); ++n) sum.back().volumes[n] += in_a->volumes[n];
            ++in_a;
        }
        sum.insert(sum.end(), in_a, a.end());
        return sum;
    }

    // `at`: of the tile's own nodes.
    double openShare(std::uint32_t layer, std::size_t at, double open) const {
        const auto i = static_cast<int>(at % kTileCells);
        const auto j = static_cast<int>(at / kTileCells);
        double solid = 0;
        // A node between tiles of sums has some of each.
        for (int y = j / kSumCells + (j % kSumCells == 0 ? 0 : 1); y <= j / kSumCells + 1; ++y)
            for (int x = i / kSumCells + (i % kSumCells == 0 ? 0 : 1); x <= i / kSumCells + 1; ++x) {
                const TileSums::Layer* sums = around_.at(x, y).of(layer);
                const int column = i - (x - 1) * kSumCells;
                const int row = j - (y - 1) * kSumCells;
                if (sums == nullptr || sums->solid.empty() || !sums->box.has(column, row)) continue;
                solid += static_cast<double>(sums->solid[sums->placeOf(row, column)]);
            }
        return solid > 0 ? std::min(open / solid, 1.0) : 0;
    }

    // Whether the tile's own nodes have sums of a layer. The first of them have some of the tiles before it too.
    static bool reaches(const SumsAround& around, std::uint32_t layer) {
        for (int y = 0; y + 1 < SumsAround::kEdge; ++y)
            for (int x = 0; x + 1 < SumsAround::kEdge; ++x)
                if (around.at(x, y).of(layer) != nullptr) return true;
        return false;
    }

    const LayerStack& stack_;
    const std::uint32_t own_from_;  // layer
    const SumsAround& around_;
    const SumsAround* below_;
    std::array<AllVolumes, kUpLayers + kTileLayers> up_;  // what has no place, by layer
    SpreadRoom& room_ = roomOfThread();
    Values out_, rise_, open_;
};

}  // namespace

SwellTile spreadTile(const LayerStack& stack, TilePlace place, const SumsAround& around, const SumsAround* below) {
    return TileSpread(stack, place, around, below).spread();
}

}  // namespace stratum::voxelize
