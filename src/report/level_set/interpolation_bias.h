// What trilinear interpolation adds to a field of distances, cell by cell.
#pragma once

namespace stratum::report {

/// Samples of a leaf's cells: [x][y][z], with the next one along each axis.
using CellSamples = float[9][9][9];
/// One number a cell.
using CellNumbers = float[8][8][8];

/// The mean over each cell of the interpolated field less the one that was sampled: a twelfth of the second differences
/// along the axes, in the unit of the samples. A convex surface of radius r (voxels) is interpolated 1/(12 r) voxels
/// too deep, and a solid loses that much of its volume.
///
/// Along an axis it takes the second difference at the nearer or the farther sample plane of the cell, the smaller one
/// (as ENO schemes choose: A. Harten et al., J. Computational Physics 71, 1987): so none goes across a crease, such as
/// the grooves between layers, which lie on sample planes. Corners of less than two voxels' radius are not resolved,
/// and left as they are. Only differences within the samples are used.
/// @param voxel  in the unit of the samples
/// @param edge  cells along x and y, at least 2; the samples beyond them are not read, and other cells' bias is not set
void interpolationBias(const CellSamples& samples, double voxel, CellNumbers& bias, int edge = 8);

}  // namespace stratum::report
