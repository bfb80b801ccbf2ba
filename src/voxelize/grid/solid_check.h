// Checks whether a lattice is fine enough for the solid of the beads, without a grid or with a few leaves of it.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/lattice.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace stratum::voxelize {

/// Share (0..1) of the beads whose middle is not solid on the lattice: the field of the union, exact at the eight
/// samples around it and trilinear between them, is not negative there. Tests at most 512 beads: 32 consecutive ones at
/// 16 positions along the print. So a share of a few per cent is accurate to a few per cent. Only beads near those are
/// evaluated. `selection` ascending, not empty.
double lostShare(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection, const Lattice& lattice);

/// Volume of the beads of `selection` without overlaps: lengths times section areas, mm^3.
double depositedVolume(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection);

/// Relative difference of the enclosed from the deposited volume above which a report should mention it. Beads
/// overlap where they cross and turn, and gaps narrower than a voxel are filled: see docs/level_set.md for real prints.
constexpr double kVolumeDoubt = 0.15;

}  // namespace stratum::voxelize
