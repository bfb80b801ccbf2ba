#include "voxelize/swell/swell_field.h"

#include "voxelize/swell/spread.h"
#include "voxelize/swell/tile_sums.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace stratum::voxelize {
namespace {

int floorTo(int value, int step) { return (value >= 0 ? value : value - step + 1) / step; }

constexpr int kSpreadEdge = kTileCells + 2 * kSpreadHalo;

// The nodes of a tile and the halo around it, of one layer, from the sums of the tiles around. `nodes`: 0 before.
void gather(const std::array<const TileSums*, 9>& around, std::uint32_t layer, SpreadNodes& nodes) {
    static_assert(kSpreadHalo <= kTileCells);
    for (int tile = 0; tile < 9; ++tile) {
        const TileSums::Layer* sums = around[static_cast<std::size_t>(tile)]->of(layer);
        if (sums == nullptr) continue;
        const int to_x = (tile % 3 - 1) * kTileCells + kSpreadHalo;
        const int to_y = (tile / 3 - 1) * kTileCells + kSpreadHalo;
        const int first = std::max(0, -to_x);
        const int count = std::min(TileSums::kNodes, nodes.edge - to_x) - first;
        for (int j = std::max(0, -to_y); j < std::min(TileSums::kNodes, nodes.edge - to_y); ++j) {
            const auto add = [&](const TileSums::Nodes& values, std::vector<float>& row_by_row) {
                const float* const from = values.data() + nodeIndex(j, TileSums::kNodes, first);
                float* const to = row_by_row.data() + nodeIndex(j + to_y, nodes.edge, first + to_x);
                for (int i = 0; i < count; ++i) to[i] += from[i];
            };
            add(sums->surplus, nodes.surplus);
            for (std::size_t level = 0; level < nodes.gain.size(); ++level) add(sums->gain[level], nodes.gain[level]);
            add(sums->open, nodes.open);
        }
    }
}

// Spreads the surplus of a tile's layers, from the lowest: what has no place in one may find it in the next.
class TileSpread {
public:
    TileSpread(const LayerStack& stack, const std::array<const TileSums*, 9>& around) : stack_(stack), around_(around) {
        // A tile's first nodes have sums of the tiles before it too.
        for (const std::size_t n : {0, 1, 3, 4})
            layers_.insert(layers_.end(), around[n]->layers.begin(), around[n]->layers.end());
        std::sort(layers_.begin(), layers_.end());
        layers_.erase(std::unique(layers_.begin(), layers_.end()), layers_.end());
        up_.resize(layers_.size());
    }

    SwellTile spread() {
        for (std::size_t number = 0; number < layers_.size(); ++number) spreadLayer(number);
        return {out_.arranged(), rise_.arranged(), open_.arranged()};
    }

private:
    using Volumes = std::vector<double>;  // mm^3, of the nodes that the tile owns; empty: none

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
        NodeValues arranged() { return {std::move(layers), values}; }
    };

    void spreadLayer(std::size_t number) {
        const std::uint32_t layer = layers_[number];
        const Layer& of = stack_.layers[layer];
        gather(around_, layer, nodes_);
        const NodeBox box = nodes_.box();
        constexpr NodeBox kOwn{kSpreadHalo, kSpreadHalo + kTileCells, kSpreadHalo, kSpreadHalo + kTileCells};
        const Spread& spread = spreading_.spread(nodes_, box, kOwn, of.most_rise);
        const Volumes below = takeFromBelow(layer);
        for (int j = 0; j < kTileCells; ++j)
            for (int i = 0; i < kTileCells; ++i) {
                const std::size_t n = nodeIndex(j + kSpreadHalo, kSpreadEdge, i + kSpreadHalo);
                const std::size_t own = nodeIndex(j, kTileCells, i);
                // What comes from below takes what room the layer's own surplus has left, and the rest goes on.
                double moves_up = std::max(static_cast<double>(spread.left[n]) + (below.empty() ? 0 : below[own]), 0.0);
                const auto open = static_cast<double>(nodes_.open[n]);
                const bool crowned = open > 0 && of.crown > 0;
                if (!(moves_up > 0 || spread.given[n] > 0 || spread.raised[n] > 0 || crowned)) continue;
                const auto place = [&moves_up](float already, double most) {
                    const double more = std::clamp(most - static_cast<double>(already), 0.0, moves_up);
                    moves_up -= more;
                    return static_cast<double>(already) + more;
                };
                const double given = place(spread.given[n], static_cast<double>(nodes_.gain.back()[n]));
                const double raised = place(spread.raised[n], open * of.most_rise);
                if (moves_up > 0) {
                    if (up_[number].empty()) up_[number].assign(NodeValues::kNodes, 0.0);
                    up_[number][own] = moves_up;
                }
                out_.set(layer, own, swellThatGains(nodes_, n, given));
                if (!(open > 0)) continue;
                rise_.set(layer, own, std::min(raised / open, of.most_rise));
                if (crowned) open_.set(layer, own, openShare(layer, i, j, open));
            }
        nodes_.clear(box);
    }

    // What the layers on which this one lies have left at each node.
    Volumes takeFromBelow(std::uint32_t layer) {
        Volumes sum;
        const auto first = std::lower_bound(stack_.welds.begin(), stack_.welds.end(), layer,
                                            [](const Weld& weld, std::uint32_t upper) { return weld.upper < upper; });
        for (auto weld = first; weld != stack_.welds.end() && weld->upper == layer; ++weld) {
            const auto lower = std::lower_bound(layers_.begin(), layers_.end(), weld->lower);
            if (lower == layers_.end() || *lower != weld->lower) continue;
            // Another layer that lies on the same one finds nothing.
            const Volumes left = std::exchange(up_[static_cast<std::size_t>(lower - layers_.begin())], {});
            if (sum.empty()) sum.resize(left.size());
            for (std::size_t n = 0; n < left.size(); ++n) sum[n] += left[n];
        }
        return sum;
    }

    double openShare(std::uint32_t layer, int i, int j, double open) const {
        double solid = 0;
        for (const std::size_t n : {0, 1, 3, 4}) {
            const int in_x = i + (n % 3 == 0 ? kTileCells : 0);
            const int in_y = j + (n / 3 == 0 ? kTileCells : 0);
            const TileSums::Layer* sums = around_[n]->of(layer);
            if (in_x >= TileSums::kNodes || in_y >= TileSums::kNodes || sums == nullptr) continue;
            solid += static_cast<double>(sums->solid[nodeIndex(in_y, TileSums::kNodes, in_x)]);
        }
        return solid > 0 ? std::min(open / solid, 1.0) : 0;
    }

    const LayerStack& stack_;
    const std::array<const TileSums*, 9>& around_;
    std::vector<std::uint32_t> layers_;
    std::vector<Volumes> up_;         // what has no place, by layers_
    SpreadNodes nodes_{kSpreadEdge};  // of the layer at hand; 0 between layers
    Spreading spreading_{kSpreadEdge};
    Values out_, rise_, open_;
};

}  // namespace

const TileSums::Layer* TileSums::of(std::uint32_t layer) const {
    const auto found = std::lower_bound(layers.begin(), layers.end(), layer);
    if (found == layers.end() || *found != layer) return nullptr;
    return sums[static_cast<std::size_t>(found - layers.begin())].get();
}

NodeValues::NodeValues(std::vector<std::uint32_t> layers, const std::vector<float>& values)
    : layers_(std::move(layers)), values_(values.size()) {
    static_assert(kTileCells % kBlock == 0);
    float* to = values_.data();
    for (int block_j = 0; block_j < kTileCells; block_j += kBlock)
        for (int block_i = 0; block_i < kTileCells; block_i += kBlock)
            for (std::size_t place = 0; place < layers_.size(); ++place)
                for (int j = block_j; j < block_j + kBlock; ++j, to += kBlock)
                    std::copy_n(values.data() + place * kNodes + nodeIndex(j, kTileCells, block_i), kBlock, to);
}

std::size_t NodeValues::find(std::uint32_t layer, std::size_t guess) const {
    if (guess <= layers_.size() && (guess == 0 || layers_[guess - 1] < layer) &&
        (guess == layers_.size() || layers_[guess] >= layer))
        return guess;
    return static_cast<std::size_t>(std::lower_bound(layers_.begin(), layers_.end(), layer) - layers_.begin());
}

float NodeValues::at(std::uint32_t layer, int i, int j) const {
    const std::size_t place = find(layer);
    return place < layers_.size() && layers_[place] == layer ? of(place, i, j) : 0.0F;
}

void SwellField::list(const gcode::Toolpath& toolpath, const LayerStack& stack) const {
    // Isolated: a thread that waits for its own loop must not take up work that waits for this list.
    tbb::this_task_arena::isolate([&] {
        bins_ = std::make_unique<PlanBins>(toolpath, stack, cellLattice(), std::numeric_limits<std::size_t>::max());
    });
    static_assert(PlanBins::kBlockColumns * 2 == kTileCells);
    // A tile beyond the outermost columns shares nodes with them.
    for (const PlanBins::Block& block : bins_->blocks())
        for (int dx = -1; dx <= 1; ++dx)
            for (int dy = -1; dy <= 1; ++dy) index_.add(block.x + dx, block.y + dy);
    tiles_ = std::make_unique<Tile[]>(index_.size());
}

SwellField::Tile* SwellField::find(int x, int y) const {
    const std::uint32_t n = index_.find(x, y);
    return n == PlanIndex::kNone ? nullptr : &tiles_[n];
}

const TileSums& SwellField::sumsOf(const gcode::Toolpath& toolpath, const LayerStack& stack, Tile& tile, int x,
                                   int y) const {
    std::call_once(tile.summed, [&] { tile.sums = sumTile(toolpath, stack, *bins_, x, y); });
    return tile.sums;
}

const SwellTile* SwellField::tile(const gcode::Toolpath& toolpath, const LayerStack& stack, int x, int y) const {
    std::call_once(listed_, [&] { list(toolpath, stack); });
    Tile* own = find(x, y);
    if (own == nullptr) return nullptr;
    std::call_once(own->spread, [&] {
        static const TileSums kNothing;
        std::array<Tile*, 9> tiles{};
        std::array<const TileSums*, 9> around{};
        for (int n = 0; n < 9; ++n) {
            const auto at = static_cast<std::size_t>(n);
            const int other_x = x + n % 3 - 1;
            const int other_y = y + n / 3 - 1;
            tiles[at] = find(other_x, other_y);
            around[at] = tiles[at] == nullptr ? &kNothing : &sumsOf(toolpath, stack, *tiles[at], other_x, other_y);
        }
        own->swell = TileSpread(stack, around).spread();
        // The last tile that needs the sums of another lets go of them.
        for (std::size_t n = 0; n < tiles.size(); ++n) {
            if (tiles[n] == nullptr) continue;
            int neighbours = 0;
            for (int m = 0; m < 9; ++m)
                neighbours += find(x + static_cast<int>(n) % 3 - 1 + m % 3 - 1,
                                   y + static_cast<int>(n) / 3 - 1 + m / 3 - 1) != nullptr;
            if (tiles[n]->uses.fetch_add(1) + 1 == neighbours) tiles[n]->sums = {};
        }
    });
    return &own->swell;
}

Swell SwellField::at(const gcode::Toolpath& toolpath, const LayerStack& stack, std::uint32_t layer, double x,
                     double y) const {
    const double in_x = x / kNodeSpacing;
    const double in_y = y / kNodeSpacing;
    const int i = static_cast<int>(std::floor(in_x));
    const int j = static_cast<int>(std::floor(in_y));
    Swell sum;
    for (int n = 0; n < 4; ++n) {
        const int node_i = i + n % 2;
        const int node_j = j + n / 2;
        const int tile_x = floorTo(node_i, kTileCells);
        const int tile_y = floorTo(node_j, kTileCells);
        const SwellTile* from = tile(toolpath, stack, tile_x, tile_y);
        if (from == nullptr) continue;
        const auto valueOf = [&](const NodeValues& values) {
            return static_cast<double>(values.at(layer, node_i - tile_x * kTileCells, node_j - tile_y * kTileCells));
        };
        const double weight = nodeShare(1 - std::abs(in_x - node_i)) * nodeShare(1 - std::abs(in_y - node_j));
        sum.out += weight * valueOf(from->out);
        sum.rise += weight * valueOf(from->rise);
        sum.open += weight * valueOf(from->open);
    }
    return sum;
}

}  // namespace stratum::voxelize
