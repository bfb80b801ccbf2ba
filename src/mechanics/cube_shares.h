// Toolpath -> the share of each cube that is plastic.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/lattice.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace stratum::mechanics {

/// Sides of a cube; side ^ 1 is the opposite one.
enum CubeSide : std::uint8_t { x_low, x_high, y_low, y_high, z_low, z_high };
constexpr std::size_t kCubeSides = 6;

/// A cube with plastic in it.
struct CubeShare {
    std::int32_t i = 0, j = 0, k = 0;  ///< its place, counted in cubes
    float share = 0;                   ///< of its volume, 0 to 1
    std::uint8_t reached = 0;          ///< bit n: its plastic reaches CubeSide n
};

/// Cube (i, j, k) begins at origin + edge (i, j, k), in print space.
struct CubeShares {
    double edge = 0;               ///< mm
    double origin[3] = {0, 0, 0};  ///< mm
    std::vector<CubeShare> list;   ///< ascending k, then j, then i
    double plastic = 0;            ///< volume of the print's solid, in cubes
};

/// Measures the solid of the beads of `selection` along vertical lines: exactly on each line, layer by layer, from the
/// plan fields of the level set; sloped and round beads one by one. Lines are an eighth of a layer apart or less, three
/// by three a cube at least. `lattice` has the cubes' edge and layer planes. Parallel; the result does not depend on
/// the number of threads.
CubeShares cubeShares(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                      const voxelize::Lattice& lattice, const std::function<void(double)>& progress);

}  // namespace stratum::mechanics
