// Toolpath -> LayerStack: level beads grouped by center plane and half-height, and the pairs of layers to be welded.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/beads/settling.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace stratum::voxelize {

class SwellField;

/// Level beads of one center plane and one height, hence of one section but for their width. Their 3-D union is the 2-D
/// minimum of rho - c, so a layer is one plan field, expanded once per column.
struct Layer {
    double center_z = 0;      ///< mm
    double radius = 0;        ///< mm, of the corners; see Section
    double half_side = 0;     ///< mm
    double inset = 0;         ///< mm, flatInset(): half the flat of a bead is half of Bead::width less this
    std::uint32_t first = 0;  ///< ranks [first, last) of LayerStack::beads, in print order
    std::uint32_t last = 0;
    const SettlingCurve* settling = nullptr;  ///< of LayerStack::curves; null: beads don't settle
    double most_rise = 0;                     ///< mm, the most by which its top is raised: swell_field.h
    double crown = 0;                         ///< mm, DepositModel::crown

    double halfHeight() const { return radius + half_side; }
    double bottom() const { return center_z - halfHeight(); }
    /// The highest that any of it may be; the plane of the flats where nothing is raised.
    double top() const { return center_z + halfHeight() + most_rise; }
};

/// `upper` rests on `lower`: the top plane of one is the bottom plane of the other. Two flats that touch exactly leave
/// phi = 0 on the plane between them, a crack of no thickness inside the solid. The weld adds the body that both share,
/// {max(D_lower, D_upper) <= 0} between the two center planes, which lies inside the union and moves no surface.
struct Weld {
    std::uint32_t lower = 0;  ///< index into LayerStack::layers
    std::uint32_t upper = 0;
};

/// Planes closer than this fraction of the thinner layer's height touch (slicers print Z with three decimals).
constexpr double kWeldGap = 0.02;

/// The selected beads, ordered by layer. A bead's rank is its index in this order; bins and columns refer to it.
struct LayerStack {
    std::vector<Layer> layers;         ///< ascending center_z, then radius
    std::vector<Weld> welds;           ///< ordered by (upper, lower)
    std::vector<std::uint32_t> beads;  ///< by rank: index into Toolpath::beads. Layers first, then direct beads
    std::vector<std::uint32_t> layer;  ///< by rank: index into layers; layers.size() for a direct bead
    std::uint32_t first_direct = 0;    ///< rank of the first sloped or round bead: evaluated in 3-D, one by one
    std::vector<Extent> extents;       ///< of the direct beads, from first_direct on
    std::vector<std::shared_ptr<const SettlingCurve>> curves;  ///< one for each shape of section; empty for capsules
    std::shared_ptr<const SwellField> swell;                   ///< null where plastic that has no place goes nowhere
    double settling_scale = 1;                                 ///< settlingScale(), where there is a swell

    std::span<const std::uint32_t> direct() const { return std::span(beads).subspan(first_direct); }
    /// Of a direct bead.
    const Extent& extentOf(std::uint32_t rank) const { return extents[rank - first_direct]; }
};

enum class LayersBy : std::uint8_t {
    plane,
    plane_and_number,  ///< Run::layer: objects that are printed one after another have layers of their own
};

/// Groups the beads of `selection` (indices into toolpath.beads, ascending). Single-threaded.
LayerStack stackLayers(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                       LayersBy by = LayersBy::plane);

}  // namespace stratum::voxelize
