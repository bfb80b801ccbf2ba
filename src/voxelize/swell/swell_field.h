// Where the plastic goes that has no place in the grooves of its layer: the outlines beside it move out.
//
// What neighbouring beads both claim fills the groove between them (settling.h). Where they claim more than the groove
// holds, or cross, or end in each other, as infill does in the wall, a surplus is left: what was fed less what the
// layer holds. The nozzle presses it sideways, into open grooves, slits and free edges nearby. Here a layer's plan
// distance u becomes u - swell, with a swell (mm, 0 .. kMostSwell) that is bilinear between nodes kNodeSpacing apart:
//   1. Sums over each node's tent (the bilinear weight of a node): what was fed, by the beads' exact volumes along
//   their
//      paths; what the layer holds, and what it gains if its outlines move out by a third, two thirds and all of
//      kMostSwell, by kColumnSamples points of a lattice rule in each square of two by two cells.
//   2. Each node's surplus is given to the nodes within kNear cells, in proportion to a tent and to what they can gain.
//      What is more than they can gain goes on to those within kFar cells; what is left then has no place.
//   3. At each node the swell is the one that gains what the node was given.
// The same tents weigh the gain and interpolate the swell, so the volume is kept to the second order of its changes.
//
// The result depends on the toolpath alone, not on a voxel lattice. It is local: at a point it depends on beads within
// 2 (kNear + kFar) + 1 cells and their widths. Tiles of it are made when they are first asked for.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/layer_stack.h"
#include "voxelize/beads/plan_bins.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

namespace stratum::voxelize {

constexpr double kNodeSpacing = 0.4;  ///< mm
constexpr int kTileCells = 16;        ///< along the edge of a tile
constexpr int kNear = 2;              ///< cells: about two widths of a line
constexpr int kFar = 4;               ///< cells

/// Of a node, in rows of `width` nodes.
constexpr std::size_t nodeIndex(int row, int width, int column) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
}

/// What a tile of one layer holds, by its 17 x 17 nodes: sums over the tile's own cells, mm^3.
struct TileSums {
    static constexpr int kNodes = kTileCells + 1;
    static constexpr int kLevels = 3;
    using Nodes = std::array<float, std::size_t{kNodes} * kNodes>;
    struct Layer {
        Nodes surplus{};                    ///< fed less held
        std::array<Nodes, kLevels> gain{};  ///< where outlines move out by (n + 1) / kLevels of kMostSwell
    };
    std::vector<std::uint32_t> layers;  ///< indices into LayerStack::layers, ascending
    std::vector<Layer> sums;            ///< in the same order

    const Layer* of(std::uint32_t layer) const;
};

/// The swell of a tile, mm, by the 16 x 16 nodes that it owns. Layers without any are left out.
struct SwellTile {
    using Nodes = std::array<float, std::size_t{kTileCells} * kTileCells>;
    std::vector<std::uint32_t> layers;  ///< ascending
    std::vector<Nodes> swell;           ///< in the same order

    const Nodes* of(std::uint32_t layer) const;
};

/// Swell tiles of a print, made on demand. Shared by all threads.
class SwellField {
public:
    /// The tile that owns the nodes 16 x .. 16 x + 15 along each axis, node 0 at the origin; null if no bead is near.
    /// `toolpath` and `stack` are the same at each call, and the field belongs to that stack.
    const SwellTile* tile(const gcode::Toolpath& toolpath, const LayerStack& stack, int x, int y) const;

    /// At a point of the plan (mm), mm. Slow: for tests and measurements.
    double at(const gcode::Toolpath& toolpath, const LayerStack& stack, std::uint32_t layer, double x, double y) const;

private:
    struct Tile {
        std::once_flag summed, spread;
        TileSums sums;
        SwellTile swell;
    };
    void list(const gcode::Toolpath& toolpath, const LayerStack& stack) const;
    Tile* find(int x, int y) const;
    const TileSums& sumsOf(const gcode::Toolpath& toolpath, const LayerStack& stack, Tile& tile, int x, int y) const;

    mutable std::once_flag listed_;
    mutable std::unique_ptr<PlanBins> bins_;                             // squares of two by two cells
    mutable int first_x_ = 0, first_y_ = 0, count_x_ = 0, count_y_ = 0;  // tiles
    mutable std::unique_ptr<Tile[]> tiles_;
};

}  // namespace stratum::voxelize
