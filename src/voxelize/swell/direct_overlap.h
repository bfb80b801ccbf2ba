// What layers share with sloped and round beads: plastic that was fed twice, and is surplus of the layer.
#pragma once

#include "voxelize/leaf/leaf_column.h"
#include "voxelize/swell/node_sums.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace stratum::voxelize {

/// The sloped and round beads over the points of one column after the other. Round ends that hold more than was fed are
/// left out.
class DirectOverlap {
public:
    /// Beads that reach between `low` and `high`, mm. The references must outlive the object.
    DirectOverlap(const gcode::Toolpath& toolpath, const LayerStack& stack, double low, double high)
        : toolpath_(toolpath), stack_(stack), low_(low), high_(high) {}

    /// Of a column of Kind::spread or Kind::spread_without_swell that is open; `ranks`: all that reach it, ascending.
    void gather(const LeafColumn& column, std::span<const std::uint32_t> ranks);
    /// Whether any reaches between the planes of a layer.
    bool meets(const Layer& layer) const { return lowest_ < layer.top() && highest_ > layer.bottom(); }
    /// What they and the layer both have at each point, mm, into `shared`; and takes from the layer's gains what it
    /// would share besides. `pressed`: of pressLayer().
    void share(const Layer& layer, std::array<PlanField, PressedLayer::kFields>& pressed, PlanField& shared) const;
    /// Bit c: at point c they are in the way of the layer's top.
    std::uint64_t covered(const Layer& layer) const;

private:
    struct Piece {
        std::uint32_t point = 0;
        Extent extent;
    };

    const gcode::Toolpath& toolpath_;
    const LayerStack& stack_;
    const double low_, high_;
    double lowest_ = 0, highest_ = 0;
    std::vector<Piece> pieces_;  // by point, ascending; those of a point are disjoint
};

}  // namespace stratum::voxelize
