// Where the plastic goes that has no place in the grooves of its layer: outlines move out, and tops rise.
//
// What neighbouring beads both claim fills the groove between them (settling.h). Where they claim more than the groove
// holds, or cross, or end in each other, as infill does in the wall, a surplus is left: what was fed less what the
// layer holds. The nozzle presses it sideways, into open grooves, slits and free edges nearby; what finds no room there
// stands up beside the nozzle, if no other layer lies on it.
// A layer's plan distance u becomes u - swell, and what is above its center plane is moved up by the rise (mm). Both
// are interpolated between nodes kNodeSpacing apart, by nodeShare() along each axis:
//   1. Sums over each node's tent (its weight in that), by kColumnSamples points of a lattice rule in each
//      square of two by two cells: what was fed, by the beads' exact volumes along their paths; what the layer holds;
//      what it gains if its outlines move out by each of TileSums::kSwells; and the area of its top, as far as no layer
//      is welded to it from above.
//   2. Each node's surplus is given to the nodes within kNear cells, in proportion to a tent and to what they can gain.
//   3. What is left raises the open tops within kUp cells, by Layer::most_rise at most.
//   4. What is left then goes to what can gain within kFar cells, and what a node holds more than it was fed is taken
//      back from there. The rest moves up at its node, from layer to welded layer, into what can gain there, until it
//      raises an open top. What that cannot take has no place.
//   5. At each node the swell is the one that gains what the node was given, and the rise is the volume over the area.
// The same tents weigh gain and area and interpolate swell and rise, so the volume is kept to the second order of their
// changes.
//
// The result depends on the toolpath alone, not on a voxel lattice. It is local: at a point it depends on beads within
// kSpreadHalo + 1 cells and their widths, in its layer and in those that it lies on. Tiles of it are made when they are
// first asked for.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/layer_stack.h"
#include "voxelize/beads/plan_bins.h"
#include "voxelize/beads/settling.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

namespace stratum::voxelize {

constexpr double kNodeSpacing = 0.4;  ///< mm
/// Along the edge of a tile. A tile's halo is computed with it: larger ones compute less twice, and a brick waits
/// longer.
constexpr int kTileCells = 32;
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

/// What a tile of one layer holds, by its kTileCells + 1 nodes along each edge: sums over the tile's own cells.
struct TileSums {
    static constexpr int kNodes = kTileCells + 1;
    static constexpr int kLevels = 3;
    /// mm. Closer where they are small: slits between lines are full after some micrometres, so the gain of a first
    /// small swell is much larger than that of the next.
    static constexpr std::array<double, kLevels> kSwells{kMostSwell / 9, kMostSwell * 4 / 9, kMostSwell};
    using Nodes = std::array<float, std::size_t{kNodes} * kNodes>;
    struct Layer {
        Nodes surplus{};                    ///< mm^3, fed less held
        std::array<Nodes, kLevels> gain{};  ///< mm^3, where outlines move out by kSwells
        Nodes solid{};                      ///< mm^2 of the plan with plastic; only with crowns
        Nodes open{};                       ///< mm^2 of it with no layer welded to it from above
    };
    std::vector<std::uint32_t> layers;         ///< indices into LayerStack::layers, ascending
    std::vector<std::unique_ptr<Layer>> sums;  ///< in the same order

    const Layer* of(std::uint32_t layer) const;
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
    /// `layers` ascending; `values` of each in the same order, row by row.
    NodeValues(std::vector<std::uint32_t> layers, const std::vector<float>& values);

    /// Ascending.
    const std::vector<std::uint32_t>& layers() const { return layers_; }
    /// The place in layers() of a layer, or of the next one; `guess` is tried first.
    std::size_t find(std::uint32_t layer, std::size_t guess = 0) const;
    /// 0 where the layer is left out.
    float at(std::uint32_t layer, int i, int j) const;
    /// Of the layer at that place.
    float of(std::size_t place, int i, int j) const {
        const int block = j / kBlock * (kTileCells / kBlock) + i / kBlock;
        const int within = j % kBlock * kBlock + i % kBlock;
        return values_[(static_cast<std::size_t>(block) * layers_.size() + place) * kBlockNodes +
                       static_cast<std::size_t>(within)];
    }

    bool operator==(const NodeValues&) const = default;

private:
    std::vector<std::uint32_t> layers_;
    std::vector<float> values_;
};

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
    /// The tile that owns the nodes from kTileCells x on along each axis, node 0 at the origin; null if no bead is
    /// near. `toolpath` and `stack` are the same at each call, and the field belongs to that stack.
    const SwellTile* tile(const gcode::Toolpath& toolpath, const LayerStack& stack, int x, int y) const;

    /// At a point of the plan (mm). Slow: for tests and measurements.
    Swell at(const gcode::Toolpath& toolpath, const LayerStack& stack, std::uint32_t layer, double x, double y) const;

private:
    struct Tile {
        std::once_flag summed, spread;
        TileSums sums;              // until the tile and those around it are spread
        std::atomic<int> uses = 0;  // how many of those are
        SwellTile swell;
    };
    void list(const gcode::Toolpath& toolpath, const LayerStack& stack) const;
    Tile* find(int x, int y) const;
    const TileSums& sumsOf(const gcode::Toolpath& toolpath, const LayerStack& stack, Tile& tile, int x, int y) const;

    mutable std::once_flag listed_;
    mutable std::unique_ptr<PlanBins> bins_;  // squares of two by two cells
    mutable PlanIndex index_;                 // of tiles_
    mutable std::unique_ptr<Tile[]> tiles_;
};

}  // namespace stratum::voxelize
