// How far a print is at equal steps of time, or of what is extruded.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace stratum::voxelize {

/// What passes equally from step to step.
enum class GrowthBy {
    volume,  ///< what is laid
    time,    ///< Toolpath::timing; without it, extruding at the programmed speeds; without those, volume
};

/// For the steps 1 to `count` of `count`: the index in Toolpath::beads after the last selected bead that is there then,
/// as parseSnapshots() counts: beads that are finished by a time, or those that reach a volume. After the first
/// selected bead at least, so that there is something to see. Ascending, some may be equal: while the machine only
/// travels, nothing is added. The first step begins with the first selected bead, the last one ends with the last. One
/// pass over the beads.
/// @param selection  ascending, not empty
std::vector<std::uint32_t> growthMoments(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                                         std::size_t count, GrowthBy by);

}  // namespace stratum::voxelize
