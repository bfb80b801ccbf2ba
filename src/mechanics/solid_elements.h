// Toolpath -> the solid cubes of a print, each with the bead that it was printed as.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "mechanics/cube_shares.h"
#include "voxelize/beads/lattice.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace stratum::mechanics {

/// A cube that is solid.
struct SolidElement {
    std::int32_t i = 0, j = 0, k = 0;  ///< its place, counted in cubes
    std::uint32_t bead = 0;            ///< index into Toolpath::beads: the one whose surface is nearest to the middle
};

/// Cubes of a print. Cube (i, j, k) begins at origin + edge (i, j, k), in print space.
struct SolidElements {
    double edge = 0;                 ///< mm
    double origin[3] = {0, 0, 0};    ///< mm
    std::vector<SolidElement> list;  ///< ascending k, then j, then i

    double plastic = 0;  ///< volume of the print's solid, mm^3

    double volume() const { return static_cast<double>(list.size()) * edge * edge * edge; }  ///< mm^3
};

struct SolidOptions {
    std::size_t most = 0;                  ///< more elements are refused; 0: no limit
    std::function<void(double)> progress;  ///< fraction done, one thread at a time
};

/// Cubes of the lattice's voxel size, whose faces lie on layer planes where the lattice's planes do; which of them are
/// solid: see chosenCubes(). The solid is that of the level set: beads, and what closes the planes between layers.
/// `selection`: indices into toolpath.beads, ascending. Parallel; the result does not depend on the number of threads.
/// Throws UsageError, with a size that fits, if there are more than `most`, and if a layer has more than kMostPerLayer
/// cubes.
SolidElements solidElements(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                            const voxelize::Lattice& lattice, const SolidOptions& options = {});

constexpr double kMostPerLayer = 16;

// The share of each cube that is plastic -> which cubes are solid.

/// Indices into CubeShares::list, ascending.
///
/// In each block of 32 x 32 x 32 cubes the fullest ones, as many as hold the block's plastic; what is over or missing
/// by rounding goes on to the next block. Then pieces are joined whose plastic is: by cubes with plastic, on the ways
/// of which the least is missing. For each of those the least full cube is left out whose neighbours stay joined
/// without it, in the same block or the next that has one. So the volume is that of the plastic, to half a cube, unless
/// joining needs more than there is to leave out: where cubes are wider than walls.
std::vector<std::uint32_t> chosenCubes(const CubeShares& cubes);

// Which bead a cube was printed as.

/// Sets SolidElement::bead of all elements: of the beads of `selection` the one whose surface is nearest to the middle.
/// `lattice`: of which layer planes, see solidElements(). Parallel.
void setBeads(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
              const voxelize::Lattice& lattice, SolidElements& elements);

}  // namespace stratum::mechanics
