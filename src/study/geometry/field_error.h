// How far the voxels of a grid are from the exact field of the beads.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/lattice.h"
#include "voxelize/grid/voxelizer.h"

namespace stratum::study {

/// Voxelizes and compares samples of every leaf (or of as many as `most_voxels` allows, evenly chosen) with the minimum
/// over all beads in double. Outside: the difference of the distances, both clamped to the band. Inside, where values
/// are a bound: how far above zero. The largest, mm; NaN if any sample is not a finite number.
double largestFieldError(const gcode::Toolpath& toolpath, const voxelize::Lattice& lattice,
                         const voxelize::VoxelizeOptions& options = {}, std::size_t most_voxels = 40000);

/// What float arithmetic may add to a distance, mm. A distance is made of a difference of coordinates, a projection
/// (two products, a sum), its clamp, a difference, a root of two squares and a difference: eight roundings of 2^-24,
/// each of a length no larger than the longest at hand: a leaf, the band, or half of the widest bead.
double fieldTolerance(const gcode::Toolpath& toolpath, const voxelize::Lattice& lattice);

/// A lattice through z = 0.
voxelize::Lattice plainLattice(double voxel_size, double layer_height, double half_width = 3);

}  // namespace stratum::study
