#include "voxelize/swell/swell_field.h"

#include "base/parallel_for.h"
#include "voxelize/swell/layer_needs.h"
#include "voxelize/swell/node_sums.h"
#include "voxelize/swell/tile_spread.h"
#include "voxelize/swell/tile_sums.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace stratum::voxelize {
NodeValues::NodeValues(const std::vector<std::uint32_t>& layers, const std::vector<float>& values)
    : values_(values.size()) {
    static_assert(kTileCells % kBlock == 0);
    for (const std::uint32_t layer : layers) present_ |= 1U << layer % kTileLayers;
    float* to = values_.data();
    for (int block_j = 0; block_j < kTileCells; block_j += kBlock)
        for (int block_i = 0; block_i < kTileCells; block_i += kBlock)
            for (std::size_t place = 0; place < layers.size(); ++place)
                for (int j = block_j; j < block_j + kBlock; ++j, to += kBlock)
                    std::copy_n(values.data() + place * kNodes + nodeIndex(j, kTileCells, block_i), kBlock, to);
}

SwellField::SwellField() = default;
SwellField::~SwellField() = default;

void SwellField::makeList(const gcode::Toolpath& toolpath, const LayerStack& stack) const {
    // Isolated: a thread that waits for its own loop must not take up work that waits for this list.
    tbb::this_task_arena::isolate([&] {
        bins_ = std::make_unique<PlanBins>(toolpath, stack, cellLattice(stack.settling_scale),
                                           std::numeric_limits<std::size_t>::max());
    });
    needs_ = std::make_unique<LayerNeeds>(stack);
    constexpr int kBlockCells = PlanBins::kBlockColumns * kSquareCells;
    static_assert(kBlockCells % kTileCells == 0);
    // A tile beyond the outermost columns shares nodes with them.
    const auto add = [&](auto& tiles, int cells, int more) {
        const int edge = kBlockCells / cells;
        for (const PlanBins::Block& block : bins_->blocks())
            for (int y = block.y * edge - more; y < (block.y + 1) * edge + more; ++y)
                for (int x = block.x * edge - more; x < (block.x + 1) * edge + more; ++x) tiles.add(x, y);
        tiles.finish(high_);
    };
    high_ = tilesHigh(stack);
    add(tiles_, kTileCells, 1);
    add(sums_, kSumCells, 0);
}

SwellField::AllNeeded SwellField::neededBy(TilePlace place) const {
    AllNeeded needed;
    for (const std::uint32_t below : {0, 1}) {
        if (below > place.z) break;
        for (int n = 0; n < SumsAround::kCount; ++n) {
            const TilePlace other{place.x * (kTileCells / kSumCells) - 1 + n % SumsAround::kEdge,
                                  place.y * (kTileCells / kSumCells) - 1 + n / SumsAround::kEdge, place.z - below};
            needed.push_back({sums_.find(other), other});
        }
    }
    return needed;
}

const SwellTile* SwellField::tile(const gcode::Toolpath& toolpath, const LayerStack& stack, TilePlace place) const {
    list(toolpath, stack);
    Tile* own = tiles_.find(place);
    if (own == nullptr) return nullptr;
    if (own->spread.isDone()) return &own->swell;
    const AllNeeded needed = neededBy(place);
    const auto sum = [&](const Needed& other) {
        other.tile->sums = sumTile(toolpath, stack, *needs_, *bins_, other.place);
    };
    // First what no other thread is at: two that want one tile share its sums.
    for (const Needed& other : needed)
        if (other.tile != nullptr) other.tile->summed.doUnlessAtWork([&] { sum(other); });
    own->spread.doOrWait([&] {
        for (const Needed& other : needed)
            if (other.tile != nullptr) other.tile->summed.doOrWait([&] { sum(other); });
        own->swell = spread(stack, place, needed);
        letGo(needed);
    });
    return &own->swell;
}

void SwellField::makeTiles(const gcode::Toolpath& toolpath, const LayerStack& stack, const NodeBox& nodes,
                           std::uint32_t first, std::uint32_t last) const {
    list(toolpath, stack);
    // The parts that threads take are far from one another, so that they seldom wait for the same sums.
    std::vector<TilePlace> places;
    for (std::uint32_t z = first / kTileLayers; z <= last / kTileLayers; ++z)
        for (int y = floorDivide(nodes.y0, kTileCells); y <= floorDivide(nodes.y1 - 1, kTileCells); ++y)
            for (int x = floorDivide(nodes.x0, kTileCells); x <= floorDivide(nodes.x1 - 1, kTileCells); ++x) {
                const Tile* tile = tiles_.find({x, y, z});
                if (tile != nullptr && !tile->spread.isDone()) places.push_back({x, y, z});
            }
    parallelFor(places.size(), 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t n = from; n < to; ++n) tile(toolpath, stack, places[n]);
    });
}

SwellTile SwellField::spread(const LayerStack& stack, TilePlace place, const AllNeeded& needed) const {
    static const TileSums kNothing;
    const auto from = [&needed](std::size_t first) {
        SumsAround around;
        for (std::size_t n = 0; n < around.tiles.size(); ++n) {
            const SumTile* tile = needed[first + n].tile;
            around.tiles[n] = tile != nullptr ? &tile->sums : &kNothing;
        }
        return around;
    };
    const SumsAround own = from(0);
    if (place.z == 0) return spreadTile(stack, place, own, nullptr);
    const SumsAround below = from(SumsAround::kCount);
    return spreadTile(stack, place, own, &below);
}

void SwellField::letGo(const AllNeeded& needed) const {
    // The last tile that needs the sums of another lets go of them. It needs those that it covers, and those next to
    // it.
    const auto first = [](int at) { return floorDivide((at - 1) * kSumCells, kTileCells); };
    const auto last = [](int at) { return floorDivide((at + 1) * kSumCells, kTileCells); };
    for (const Needed& other : needed) {
        if (other.tile == nullptr) continue;
        int users = 0;
        for (int y = first(other.place.y); y <= last(other.place.y); ++y)
            for (int x = first(other.place.x); x <= last(other.place.x); ++x) users += tiles_.has(x, y) ? 1 : 0;
        if (other.place.z + 1 < high_) users *= 2;
        if (other.tile->uses.fetch_add(1) + 1 == users) other.tile->sums = {};
    }
}

Swell SwellField::at(const gcode::Toolpath& toolpath, const LayerStack& stack, std::uint32_t layer, double x,
                     double y) const {
    const double in_x = x / nodeSpacing(stack);
    const double in_y = y / nodeSpacing(stack);
    const int i = static_cast<int>(std::floor(in_x));
    const int j = static_cast<int>(std::floor(in_y));
    Swell sum;
    for (int n = 0; n < 4; ++n) {
        const int node_i = i + n % 2;
        const int node_j = j + n / 2;
        const TilePlace place{floorDivide(node_i, kTileCells), floorDivide(node_j, kTileCells), layer / kTileLayers};
        const SwellTile* from = tile(toolpath, stack, place);
        if (from == nullptr) continue;
        const auto valueOf = [&](const NodeValues& values) {
            if (!values.has(layer)) return 0.0;
            return static_cast<double>(
                values.of(layer).at(node_i - place.x * kTileCells, node_j - place.y * kTileCells));
        };
        const double weight = nodeShare(1 - std::abs(in_x - node_i)) * nodeShare(1 - std::abs(in_y - node_j));
        sum.out += weight * valueOf(from->out);
        sum.rise += weight * valueOf(from->rise);
        sum.open += weight * valueOf(from->open);
    }
    return sum;
}

}  // namespace stratum::voxelize
