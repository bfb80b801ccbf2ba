// Counts the bricks that rays reached, as an image for inspection.
#pragma once

#include "march/brick/brick_grid.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace stratum::march {

/// Counts of bricks along an axis of the grid: one number for each row of bricks along it.
struct BrickProjection {
    std::size_t width = 0, height = 0;  ///< in bricks
    std::vector<std::uint32_t> listed;  ///< bricks that may have surface; row by row from the top, the largest index
    std::vector<std::uint32_t> made;    ///< those of them that are laid out, with surface or without
};

/// Along y (from the front: x to the right, z up) or along z (from above: x to the right, y up). Of a lazy grid; not
/// while rays are traced. With a bound on its bricks, evicted ones don't count.
BrickProjection projectBricks(const BrickGrid& grid, int axis);

}  // namespace stratum::march
