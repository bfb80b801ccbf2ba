// How far a print is when shares of its time, of its layers or of what is extruded are over.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace stratum::voxelize {

/// What shares are of.
enum class GrowthBy {
    volume,  ///< what is laid
    time,    ///< Toolpath::timing; without it, extruding at the programmed speeds; without those, volume
    layers,  ///< each layer is as much as another one, and goes by time within; parts one after another have their own
};

/// Shares of a print, one a moment.
struct Growth {
    GrowthBy by = GrowthBy::volume;
    std::vector<double> shares;  ///< in (0, 1], ascending, some may be equal; from 1 on all is printed
};

/// 1/count, 2/count, ... 1.
std::vector<double> equalShares(std::size_t count);

/// For each share: the index in Toolpath::beads after the last selected bead that is there then,
/// as parseSnapshots() counts: beads that are finished by a time, or those that reach a volume. After the first
/// selected bead at least, so that there is something to see. Ascending, some may be equal: while the machine only
/// travels, nothing is added. Shares begin with the first selected bead and end with the last. One pass over the beads.
/// @param selection  ascending, not empty
std::vector<std::uint32_t> growthMoments(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                                         const Growth& growth);

}  // namespace stratum::voxelize
