// Toolpath -> the solid cubes of a print, each with the bead that it was printed as.
#pragma once

#include "gcode/toolpath/toolpath.h"
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

}  // namespace stratum::mechanics
