// What layers rest on, from their plan fields: the bed, the layer below, nothing.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/lattice.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace stratum::report {

/// Angles from the vertical, degrees, of the cones of PlanContact::unsupported.
constexpr std::array<double, 3> kConeAngles = {45, 60, 75};

/// Areas of the plan, mm^2. A layer's outline is that of its beads at their widest.
struct LayerContact {
    double area = 0;       ///< within the outline
    double supported = 0;  ///< of it, within the outline of what lies directly below, or on the bed
    double contact = 0;    ///< of flats that touch flats below, or the bed
    /// Of the outline: what is farther beyond the outline below than height times the tangent of each cone's angle.
    std::array<double, kConeAngles.size()> beyond_cone{};
    bool on_bed = false;  ///< most of it lies on the bed
};

struct PlanContact {
    /// By Run::layer; of a layer without level beads all 0.
    std::vector<LayerContact> layers;
    double bed_contact = 0;  ///< flats on the bed, z = 0
    double bed_outline = 0;  ///< the outline of what lies on the bed
    double level_share = 0;  ///< of the volume of the beads, level pressed ones: sloped and round ones are not counted
};

/// Areas are sums over pixels of a quarter to a half of a layer height, each covered in part by what a straight edge at
/// its distance leaves; those beyond a cone
/// are shares of them, counted in whole pixels. Layers of one plane count apart by their numbers. Layers rest on layers
/// whose top plane is their bottom plane (LayerStack::welds). Parallel; the same areas for any number of threads.
PlanContact measureContact(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                           const voxelize::Lattice& lattice);

}  // namespace stratum::report
