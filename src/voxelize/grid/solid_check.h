// Whether a lattice can hold the solid that the beads are: checks that need no grid, or little of one.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/lattice.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace stratum::voxelize {

/// Share (0..1) of the beads whose middle is not solid on the lattice: the field of the union, exact at the eight
/// samples around it and trilinear between them, is not negative there. Of at most 512 beads, of 16 places along the
/// print, each 32 in a row: a share of a few per cent is good to a few per cent. Lists the beads near those places and
/// looks at no others. `selection` ascending, not empty.
double lostShare(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection, const Lattice& lattice);

/// What the beads of `selection` hold if none overlaps: lengths times section areas, mm^3.
double depositedVolume(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection);

/// How far (as a share of the deposited volume) an enclosed one may be from it before a report should say so. Beads
/// overlap where they cross and turn, and gaps narrower than a voxel are filled: see docs/level_set.md for real prints.
constexpr double kVolumeDoubt = 0.15;

}  // namespace stratum::voxelize
