// What beads lay: the first of the sums of swell_field.h.
#pragma once

#include "gcode/toolpath/plan_path.h"
#include "voxelize/beads/layer_stack.h"
#include "voxelize/leaf/leaf_column.h"
#include "voxelize/swell/node_sums.h"
#include "voxelize/swell/swell_field.h"

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

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
    /// Steps of a bead that may lay something in the tile.
    std::pair<int, int> stepsInTile(const gcode::Bead& bead, const gcode::PlanPath& path, double length, double width,
                                    int steps) const;
    /// Of an arc, the parts of its length between which it is within `more` mm of the tile.
    std::pair<double, double> nearTile(const gcode::PlanPath& path, double more) const;
    /// Each point lies in one cell of one tile.
    void addPoint(double x, double y, double volume, std::span<TileSums::Node> nodes) const;

    const gcode::Toolpath& toolpath_;
    const LayerStack& stack_;
    const int first_x_, first_y_;  // nodes
    const double spacing_;         // of them, mm
    const double unit_;            // mm^3, of TileSums
};

// What a layer shares with its own round beads: plastic that was fed twice, and is surplus of the layer.

/// Beads with less section than a disc of their height, such as gap fill and thin starts of lines, are in no layer, and
/// lie on the center plane of one. Over the points of one column after the other. Round ends that hold more than was
/// fed are left out. So are sloped beads, and threads of bridges, which lie between planes: beside them is air, which
/// takes what they press away, and no outline shows it.
class DirectOverlap {
public:
    /// Beads that reach between `low` and `high`, mm. The references must outlive the object.
    DirectOverlap(const gcode::Toolpath& toolpath, const LayerStack& stack, double low, double high)
        : toolpath_(toolpath), stack_(stack), low_(low), high_(high) {}

    /// Of a column of Kind::spread or Kind::spread_without_swell that is open; `ranks`: all that reach it, ascending.
    void gather(const LeafColumn& column, std::span<const std::uint32_t> ranks);
    /// Whether any lies on the center plane of a layer.
    bool meets(const Layer& layer) const;
    /// What they and the layer both have at each point, mm, into `shared`; and takes from the layer's gains what it
    /// would share besides. `pressed`: of pressLayer().
    void share(const Layer& layer, std::array<PlanField, PressedLayer::kFields>& pressed, PlanField& shared) const;

private:
    struct Piece {
        std::uint32_t point = 0;
        double center_z = 0, thickness = 0;  // mm
    };

    const gcode::Toolpath& toolpath_;
    const LayerStack& stack_;
    const double low_, high_;
    std::vector<Piece> pieces_;  // by point, from the thickest
};

}  // namespace stratum::voxelize
