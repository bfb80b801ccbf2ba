// What a layer shares with its own round beads: plastic that was fed twice, and is surplus of the layer.
#pragma once

#include "voxelize/leaf/leaf_column.h"
#include "voxelize/swell/node_sums.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace stratum::voxelize {

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
