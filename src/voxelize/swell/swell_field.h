// Where the plastic goes that has no place in the grooves of its layer: outlines move out, and tops rise.
//
// What neighbouring beads both claim fills the groove between them (settling.h). Where they claim more than the groove
// holds, or cross, or end in each other, as infill does in the wall, a surplus is left: what was fed less what the
// layer holds. The nozzle presses it sideways, into open grooves, slits and free edges nearby; what finds no room there
// stands up beside the nozzle, if no other layer lies on it.
// A layer's plan distance u becomes u - swell, and what is above its center plane is moved up by the rise (mm). Both
// are interpolated between nodes nodeSpacing() apart, by nodeShare() along each axis:
//   1. Sums over each node's tent (its weight in that), by kColumnSamples points of a lattice rule in each
//      square of two by two cells: what was fed, by the beads' exact volumes along their paths; what the layer holds,
//      without what it shares with layers before it and with its round beads (fed_volume.h); what it gains
//      if its outlines move out by each of TileSums::kSwells; and the area of its top, as far as no layer is welded to
//      it from above.
//   2. Each node's surplus is given to the nodes within kNear cells, in proportion to a tent and to what they can gain.
//   3. What is left raises the open tops within kUp cells, by Layer::most_rise at most.
//   4. What is left then goes to what can gain within kFar cells, and what a node holds more than it was fed is taken
//      back from there. The rest moves up at its node, from layer to welded layer, into what can gain there, until it
//      raises an open top; by kUpLayers at most. What that cannot take has no place.
//   5. At each node the swell is the one that gains what the node was given, and the rise is the volume over the area.
// The same tents weigh gain and area and interpolate swell and rise, so the volume is kept to the second order of their
// changes.
//
// The result depends on the toolpath alone, not on a voxel lattice. It is local: at a point it depends on beads within
// kSpreadHalo + 1 cells and their widths, in its layer and in the kUpLayers before it. Tiles of it are made when they
// are first asked for.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/layer_stack.h"
#include "voxelize/beads/plan_bins.h"
#include "voxelize/beads/settling.h"
#include "voxelize/swell/node_box.h"

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

namespace stratum::voxelize {

// Work that several threads may want, and that one of them does.

/// Work that is done once, by the thread that comes first.
class Once {
public:
    /// Does it unless it is done. False if another thread is at it.
    template <typename Work>
    bool doUnlessAtWork(const Work& work) {
        State expected = State::to_do;
        if (state_.compare_exchange_strong(expected, State::at_work)) {
            try {
                work();
            } catch (...) {
                leave(State::to_do);
                throw;
            }
            leave(State::done);
            return true;
        }
        return expected == State::done;
    }
    bool isDone() const { return state_.load() == State::done; }
    /// Does it, or waits until it is done.
    template <typename Work>
    void doOrWait(const Work& work) {
        while (!doUnlessAtWork(work)) state_.wait(State::at_work);
    }

private:
    enum class State : std::uint8_t { to_do, at_work, done };
    void leave(State state) {
        state_.store(state);
        state_.notify_all();
    }
    std::atomic<State> state_ = State::to_do;
};

class LayerNeeds;

constexpr double kNodeSpacing = 0.4;  ///< mm, at a settlingScale() of 1
inline double nodeSpacing(const LayerStack& stack) { return kNodeSpacing * stack.settling_scale; }
/// Along the edge of a tile. A tile's halo is spread with it: larger ones compute less twice, and a brick waits longer.
constexpr int kTileCells = 32;
/// Along the edge of a tile of sums. A tile needs the sums of those that it covers, and of those next to it.
constexpr int kSumCells = 16;
static_assert(kTileCells % kSumCells == 0);
/// Layers of a tile: as many of LayerStack::layers, from a multiple of it on.
constexpr std::uint32_t kTileLayers = 32;
/// Plastic finds a place in its own layer or in as many of those after it, counted by their index.
constexpr std::uint32_t kUpLayers = 8;
static_assert(kUpLayers <= kTileLayers);
constexpr int kNear = 2;  ///< cells: about two widths of a line
constexpr int kUp = 1;    ///< cells
constexpr int kFar = 4;   ///< cells

/// The share of the second of two nodes at `t`, 0 .. 1, of the way from the first: without creases at the nodes.
template <typename Number>
constexpr Number nodeShare(Number t) {
    return t * t * (3 - 2 * t);
}

/// Of a node, in rows of `width` nodes.
constexpr std::size_t nodeIndex(int row, int width, int column) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
}

/// Where a tile lies: its nodes are those from kTileCells, or kSumCells, times x and y on, node 0 at the origin, and
/// its layers those from kTileLayers z on.
struct TilePlace {
    int x = 0, y = 0;
    std::uint32_t z = 0;

    std::uint32_t firstLayer() const { return z * kTileLayers; }
};

/// Tiles one above the other.
inline std::uint32_t tilesHigh(const LayerStack& stack) {
    return static_cast<std::uint32_t>((stack.layers.size() + kTileLayers - 1) / kTileLayers);
}

/// What a tile's layers hold, by its kSumCells + 1 nodes along each edge: sums over the tile's own cells. Areas, and
/// with them volumes, are in units of the square of LayerStack::settling_scale, so that the weights of points are the
/// same for all prints.
struct TileSums {
    static constexpr int kNodes = kSumCells + 1;
    static constexpr int kLevels = 3;
    /// mm at a settlingScale() of 1. Closer where they are small: slits between lines are full after some micrometres,
    /// so the gain of a first small swell is much larger than that of the next.
    static constexpr std::array<double, kLevels> kSwells{kMostSwell / 9, kMostSwell * 4 / 9, kMostSwell};
    struct Node {
        float surplus = 0;                  ///< mm^3 per scale^2, fed less held
        std::array<float, kLevels> gain{};  ///< mm^3 per scale^2, where outlines move out by kSwells
    };
    struct Layer {
        NodeBox box;  ///< of the nodes that are not 0; of each kind those, row by row
        std::vector<Node> nodes;
        std::vector<float> open;   ///< mm^2 per scale^2 of the plan with no layer welded to it from above; empty: none
        std::vector<float> solid;  ///< mm^2 per scale^2 with plastic; only with crowns; empty: none

        /// Of a node in the box.
        std::size_t placeOf(int row, int column) const {
            return nodeIndex(row - box.y0, box.x1 - box.x0, column - box.x0);
        }
    };
    std::array<std::unique_ptr<Layer>, kTileLayers> layers;  ///< null: no bead is near

    /// Of a layer of the tile.
    const Layer* of(std::uint32_t layer) const { return layers[layer % kTileLayers].get(); }
};

/// What becomes of a layer at a node or a point.
struct Swell {
    double out = 0;   ///< mm, by which outlines move out
    double rise = 0;  ///< mm, by which the top is raised
    double open = 0;  ///< the share of the plastic that has nothing on it; only with crowns
};

/// One number for each layer and node of those that a tile owns, kTileCells along each edge. Layers with 0 all over are
/// left out. A column of leaves asks for the same few nodes of all layers: squares of kBlock x kBlock nodes have those
/// of all layers side by side.
class NodeValues {
public:
    static constexpr int kBlock = 4;
    static constexpr std::size_t kBlockNodes = std::size_t{kBlock} * kBlock;
    static constexpr std::size_t kNodes = std::size_t{kTileCells} * kTileCells;

    NodeValues() = default;
    /// `values` of each of `layers`, which ascend, in the same order, row by row.
    NodeValues(const std::vector<std::uint32_t>& layers, const std::vector<float>& values);

    /// Whether a layer of the tile is not left out.
    bool has(std::uint32_t layer) const { return (present_ >> layer % kTileLayers & 1) != 0; }
    /// Of one layer.
    struct OfLayer {
        const float* first = nullptr;
        std::size_t stride = 0;  ///< from square to square

        /// Of the square that has a node.
        const float* block(int i, int j) const {
            return first + nodeIndex(j / kBlock, kTileCells / kBlock, i / kBlock) * stride;
        }
        float at(int i, int j) const { return block(i, j)[nodeIndex(j % kBlock, kBlock, i % kBlock)]; }
    };
    /// Of a layer that is there.
    OfLayer of(std::uint32_t layer) const {
        const auto place = static_cast<std::size_t>(std::popcount(present_ & ((1U << layer % kTileLayers) - 1)));
        return {values_.data() + place * kBlockNodes, static_cast<std::size_t>(std::popcount(present_)) * kBlockNodes};
    }

    bool operator==(const NodeValues&) const = default;

private:
    std::uint32_t present_ = 0;  // bit n: the tile's layer n
    std::vector<float> values_;
};
static_assert(kTileLayers <= 32);

/// As Swell has them.
struct SwellTile {
    NodeValues out, rise, open;
};

/// mm by which a crown lowers the top of a layer: `d` is the distance from the flat of the nearest bead (mm), before
/// grooves are filled. A parabola that begins a corner radius within the flat; the whole crown at the end of the
/// section.
template <typename Number>
Number crownDepth(Number crown, Number radius, Number d) {
    const Number across = (d < radius ? (d > -radius ? d : -radius) : radius) + radius;
    return crown * across * across / (4 * radius * radius);
}

/// Swell tiles of a print, made on demand. Shared by all threads.
class SwellField {
public:
    SwellField();
    ~SwellField();
    SwellField(const SwellField&) = delete;
    SwellField& operator=(const SwellField&) = delete;

    /// Lists the beads by place, if that is not done: in parallel, unless other threads wait for it already.
    void list(const gcode::Toolpath& toolpath, const LayerStack& stack) const {
        std::call_once(listed_, [&] { makeList(toolpath, stack); });
    }

    /// The tile there; null if no bead is near. `toolpath` and `stack` are the same at each call, and the field belongs
    /// to that stack.
    const SwellTile* tile(const gcode::Toolpath& toolpath, const LayerStack& stack, TilePlace place) const;

    /// Makes the tiles with any of these nodes and any of the layers [first, last]. In parallel: threads that ask for
    /// one tile each would wait for one another.
    void makeTiles(const gcode::Toolpath& toolpath, const LayerStack& stack, const NodeBox& nodes, std::uint32_t first,
                   std::uint32_t last) const;

    /// At a point of the plan (mm). Slow: for tests and measurements.
    Swell at(const gcode::Toolpath& toolpath, const LayerStack& stack, std::uint32_t layer, double x, double y) const;

private:
    struct Tile {
        Once spread;
        SwellTile swell;
    };
    struct SumTile {
        Once summed;
        TileSums sums;              // until all tiles that need them are spread
        std::atomic<int> uses = 0;  // how many of those are
    };
    // Tiles where beads are. Those at one place of the plan are made together, when the first of them is asked for.
    template <typename Of>
    class Tiles {
    public:
        void add(int x, int y) { index_.add(x, y); }
        void finish(std::uint32_t high) {
            high_ = high;
            stacks_ = std::make_unique<Stack[]>(index_.size());
        }
        bool has(int x, int y) const { return index_.find(x, y) != PlanIndex::kNone; }
        // Null where no bead is near.
        Of* find(TilePlace place) const {
            const std::uint32_t n = index_.find(place.x, place.y);
            if (n == PlanIndex::kNone || place.z >= high_) return nullptr;
            Stack& stack = stacks_[n];
            std::call_once(stack.made, [&] { stack.tiles = std::make_unique<Of[]>(high_); });
            return &stack.tiles[place.z];
        }

    private:
        struct Stack {
            std::once_flag made;
            std::unique_ptr<Of[]> tiles;  // by TilePlace::z
        };
        PlanIndex index_;
        std::uint32_t high_ = 0;
        std::unique_ptr<Stack[]> stacks_;
    };
    struct Needed {
        SumTile* tile = nullptr;
        TilePlace place;
    };
    using AllNeeded = std::vector<Needed>;

    void makeList(const gcode::Toolpath& toolpath, const LayerStack& stack) const;
    AllNeeded neededBy(TilePlace place) const;
    SwellTile spread(const LayerStack& stack, TilePlace place, const AllNeeded& needed) const;
    void letGo(const AllNeeded& needed) const;

    mutable std::once_flag listed_;
    mutable std::unique_ptr<PlanBins> bins_;  // squares of two by two cells
    mutable std::unique_ptr<LayerNeeds> needs_;
    mutable std::uint32_t high_ = 0;  // tiles one above the other
    mutable Tiles<Tile> tiles_;
    mutable Tiles<SumTile> sums_;
};

}  // namespace stratum::voxelize
