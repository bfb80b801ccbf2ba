// Roughness of outer walls along lines that go up them.
//
// Sampling lengths are those of ISO 4288 (table 3, periodic profiles) for a period of one layer height, rounded to
// whole layers: 0.25 mm for layers up to 0.13 mm, 0.8 mm up to 0.4, 2.5 mm up to 1.3. A line has up to five. On each
// the profile is what the surface deviates from its least squares line; no other filter is applied. Ra is the mean of
// the absolute values, Rz the highest less the lowest, each the mean over the sampling lengths (ISO 4287).
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "report/level_set/field_probe.h"
#include "voxelize/beads/layer_stack.h"

#include <cstdint>
#include <span>
#include <vector>

namespace stratum::report {

struct RoughnessLine {
    Point at;           ///< where it begins
    double ra = 0;      ///< mm
    double rz = 0;      ///< mm
    double length = 0;  ///< mm, of its sampling lengths
};

/// Lines that are tried; those shorter than a sampling length are left out.
constexpr std::size_t kRoughnessLines = 96;

/// Whole layers, mm.
double samplingLength(double layer_height);

/// Places are even along all outer perimeters of the selection (without such labels: along all beads), and measured if
/// the outside is beside them, which `grid` tells; the profile is of a finer one, for in the grooves and on steps of
/// leaning walls it is the voxels that would be measured. `stack`: of all that is in the grid. Parallel; the same lines
/// for any number of threads.
std::vector<RoughnessLine> measureRoughness(const openvdb::FloatGrid& grid, const gcode::Toolpath& toolpath,
                                            const voxelize::LayerStack& stack, std::span<const std::uint32_t> selection,
                                            const voxelize::Lattice& lattice, const LeafMap& map,
                                            const Outside* outside);

}  // namespace stratum::report
