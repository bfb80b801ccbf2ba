// The thinnest wall of a print.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "report/level_set/field_probe.h"

#include <cstdint>
#include <optional>
#include <span>

namespace stratum::report {

struct ThinnestWall {
    double thickness = 0;    ///< mm
    Point at;                ///< on the bead
    std::uint32_t bead = 0;  ///< index into Toolpath::beads
    std::size_t walls = 0;   ///< beads that were measured
};

/// Across the middle of each selected bead with the outside beside it, at half of its height, the plastic in a row
/// is measured; the least counts. Nothing if no bead has the outside beside it. Parallel; the same result for any
/// number of threads.
std::optional<ThinnestWall> findThinnestWall(const openvdb::FloatGrid& grid, const gcode::Toolpath& toolpath,
                                             std::span<const std::uint32_t> selection, const voxelize::Lattice& lattice,
                                             const LeafMap& map, const Outside& outside);

}  // namespace stratum::report
