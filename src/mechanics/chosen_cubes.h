// The share of each cube that is plastic -> which cubes are solid.
#pragma once

#include "mechanics/cube_shares.h"

#include <cstdint>
#include <vector>

namespace stratum::mechanics {

/// Indices into CubeShares::list, ascending.
///
/// In each block of 32 x 32 x 32 cubes the fullest ones, as many as hold the block's plastic; what is over or missing
/// by rounding goes on to the next block. Then pieces are joined whose plastic is: by cubes with plastic, on the ways
/// of which the least is missing. For each of those the least full cube is left out whose neighbours stay joined
/// without it, in the same block or the next that has one. So the volume is that of the plastic, to half a cube, unless
/// joining needs more than there is to leave out: where cubes are wider than walls.
std::vector<std::uint32_t> chosenCubes(const CubeShares& cubes);

}  // namespace stratum::mechanics
