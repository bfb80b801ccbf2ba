#include "voxelize/swell/swell_field.h"

#include "voxelize/swell/spread.h"
#include "voxelize/swell/tile_sums.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace stratum::voxelize {
namespace {

int floorTo(int value, int step) { return (value >= 0 ? value : value - step + 1) / step; }

template <typename Value>
const Value* find(const std::vector<std::uint32_t>& layers, const std::vector<Value>& values, std::uint32_t layer) {
    const auto found = std::lower_bound(layers.begin(), layers.end(), layer);
    return found != layers.end() && *found == layer ? &values[static_cast<std::size_t>(found - layers.begin())]
                                                    : nullptr;
}

// The nodes of a tile and the halo around it, of one layer, from the sums of the tiles around.
SpreadNodes gather(const std::array<const TileSums*, 9>& around, std::uint32_t layer) {
    static_assert(kSpreadHalo <= kTileCells);
    SpreadNodes nodes(kTileCells + 2 * kSpreadHalo);
    for (int tile = 0; tile < 9; ++tile) {
        const TileSums::Layer* sums = around[static_cast<std::size_t>(tile)]->of(layer);
        if (sums == nullptr) continue;
        const int to_x = (tile % 3 - 1) * kTileCells + kSpreadHalo;
        const int to_y = (tile / 3 - 1) * kTileCells + kSpreadHalo;
        for (int j = std::max(0, -to_y); j < std::min(TileSums::kNodes, nodes.edge - to_y); ++j)
            for (int i = std::max(0, -to_x); i < std::min(TileSums::kNodes, nodes.edge - to_x); ++i) {
                const std::size_t from = nodeIndex(j, TileSums::kNodes, i);
                const std::size_t to = nodeIndex(j + to_y, nodes.edge, i + to_x);
                nodes.surplus[to] += static_cast<double>(sums->surplus[from]);
                for (std::size_t level = 0; level < nodes.gain.size(); ++level)
                    nodes.gain[level][to] += static_cast<double>(sums->gain[level][from]);
            }
    }
    return nodes;
}

SwellTile spreadTile(const std::array<const TileSums*, 9>& around) {
    SwellTile tile;
    // A tile's first nodes have sums of the tiles before it too.
    std::vector<std::uint32_t> layers;
    for (const std::size_t n : {0, 1, 3, 4})
        layers.insert(layers.end(), around[n]->layers.begin(), around[n]->layers.end());
    std::sort(layers.begin(), layers.end());
    layers.erase(std::unique(layers.begin(), layers.end()), layers.end());
    for (const std::uint32_t layer : layers) {
        const SpreadNodes nodes = gather(around, layer);
        const std::vector<double> given = spreadSurplus(nodes);
        SwellTile::Nodes swell{};
        bool any = false;
        for (int j = 0; j < kTileCells; ++j)
            for (int i = 0; i < kTileCells; ++i) {
                const std::size_t n = nodeIndex(j + kSpreadHalo, nodes.edge, i + kSpreadHalo);
                const auto value = static_cast<float>(swellThatGains(nodes, n, given[n]));
                swell[nodeIndex(j, kTileCells, i)] = value;
                any |= value > 0;
            }
        if (!any) continue;
        tile.layers.push_back(layer);
        tile.swell.push_back(swell);
    }
    return tile;
}

}  // namespace

const TileSums::Layer* TileSums::of(std::uint32_t layer) const { return find(layers, sums, layer); }
const SwellTile::Nodes* SwellTile::of(std::uint32_t layer) const { return find(layers, swell, layer); }

void SwellField::list(const gcode::Toolpath& toolpath, const LayerStack& stack) const {
    // Isolated: a thread that waits for its own loop must not take up work that waits for this list.
    tbb::this_task_arena::isolate([&] {
        bins_ = std::make_unique<PlanBins>(toolpath, stack, cellLattice(), std::numeric_limits<std::size_t>::max());
    });
    if (bins_->size() == 0) return;
    constexpr int kTileVoxels = kTileCells / 2 * kLeafDim;
    // A tile beyond the outermost columns shares nodes with them.
    first_x_ = floorTo(bins_->originI(0), kTileVoxels) - 1;
    first_y_ = floorTo(bins_->originJ(0), kTileVoxels) - 1;
    count_x_ = floorTo(bins_->originI(bins_->size() - 1), kTileVoxels) - first_x_ + 2;
    count_y_ = floorTo(bins_->originJ(bins_->size() - 1), kTileVoxels) - first_y_ + 2;
    tiles_ = std::make_unique<Tile[]>(static_cast<std::size_t>(count_x_) * static_cast<std::size_t>(count_y_));
}

SwellField::Tile* SwellField::find(int x, int y) const {
    const int i = x - first_x_;
    const int j = y - first_y_;
    if (i < 0 || j < 0 || i >= count_x_ || j >= count_y_) return nullptr;
    return &tiles_[static_cast<std::size_t>(j) * static_cast<std::size_t>(count_x_) + static_cast<std::size_t>(i)];
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
        std::array<const TileSums*, 9> around{};
        for (int n = 0; n < 9; ++n) {
            const int other_x = x + n % 3 - 1;
            const int other_y = y + n / 3 - 1;
            Tile* other = find(other_x, other_y);
            around[static_cast<std::size_t>(n)] =
                other == nullptr ? &kNothing : &sumsOf(toolpath, stack, *other, other_x, other_y);
        }
        own->swell = spreadTile(around);
    });
    return &own->swell;
}

double SwellField::at(const gcode::Toolpath& toolpath, const LayerStack& stack, std::uint32_t layer, double x,
                      double y) const {
    const double in_x = x / kNodeSpacing;
    const double in_y = y / kNodeSpacing;
    const int i = static_cast<int>(std::floor(in_x));
    const int j = static_cast<int>(std::floor(in_y));
    double sum = 0;
    for (int n = 0; n < 4; ++n) {
        const int node_i = i + n % 2;
        const int node_j = j + n / 2;
        const int tile_x = floorTo(node_i, kTileCells);
        const int tile_y = floorTo(node_j, kTileCells);
        const SwellTile* from = tile(toolpath, stack, tile_x, tile_y);
        const SwellTile::Nodes* nodes = from == nullptr ? nullptr : from->of(layer);
        if (nodes == nullptr) continue;
        const int place = (node_j - tile_y * kTileCells) * kTileCells + node_i - tile_x * kTileCells;
        sum += static_cast<double>((*nodes)[static_cast<std::size_t>(place)]) * (1 - std::abs(in_x - node_i)) *
               (1 - std::abs(in_y - node_j));
    }
    return sum;
}

}  // namespace stratum::voxelize
