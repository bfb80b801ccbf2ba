// What beads lay: the first of the sums of swell_field.h.
#pragma once

#include "gcode/toolpath/plan_path.h"
#include "voxelize/beads/layer_stack.h"
#include "voxelize/swell/swell_field.h"

#include <cstdint>
#include <span>
#include <utility>

namespace stratum::voxelize {

/// At which ends of its path the half discs of a bead are part of its volume: those that meet no other bead, where the
/// flow is simulated.
struct FedEnds {
    bool start = false, end = false;
};
FedEnds fedEnds(const gcode::Toolpath& toolpath, std::uint32_t index);

/// Lays volumes of beads along their paths, evenly over the width of a box of their height. Of one tile of sums.
class FedVolume {
public:
    FedVolume(const gcode::Toolpath& toolpath, const LayerStack& stack, TilePlace place);

    /// Adds what a level bead lays in the tile to the surplus of the nodes of its layer, all of the tile's.
    void feed(std::uint32_t rank, std::span<TileSums::Node> nodes) const;

private:
    /// Where the flow is simulated, the half discs at free ends are part of a bead's volume: lays them there, and
    /// returns their volume.
    double feedEnds(std::uint32_t index, double volume, const gcode::PlanPath& path,
                    std::span<TileSums::Node> nodes) const;
    /// Steps of a straight bead that may lay something in the tile; all of an arc.
    std::pair<int, int> stepsInTile(const gcode::Bead& bead, double length, double width, int steps) const;
    /// Each point lies in one cell of one tile.
    void addPoint(double x, double y, double volume, std::span<TileSums::Node> nodes) const;

    const gcode::Toolpath& toolpath_;
    const LayerStack& stack_;
    const int first_x_, first_y_;  // nodes
};

}  // namespace stratum::voxelize
