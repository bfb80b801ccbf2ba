// Intersectors to compare with.
#pragma once

#include "trace/intersector.h"

#include <openvdb/openvdb.h>

#include <memory>

namespace stratum::march {

// The reference intersector: OpenVDB's own LevelSetRayIntersector behind trace::Intersector.

/// Traces with openvdb::tools::LevelSetRayIntersector (Museth 2014, HDDA) and returns the geometric normal of the
/// trilinear field in the hit's cell. Keeps a reference to the grid. Throws InputError for grids that
/// requireTraceable() refuses.
std::unique_ptr<trace::Intersector> makeVdbIntersector(openvdb::FloatGrid::ConstPtr grid);

// Sphere tracing of the trilinear field: the classic method, for comparison.
//
// J. C. Hart, "Sphere Tracing" (The Visual Computer 12, 1996); over-relaxed as in B. Keinert et al., "Enhanced Sphere
// Tracing" (STAG 2014). Empty nodes of the tree are left in one step.

/// At hits the field is below a thousandth of a voxel; along grazing rays the error is larger. Steps along a surface
/// shrink with the distance: a ray that has not arrived after 2000 steps counts as a miss. Thin features between two
/// steps can be missed, since the trilinear field may change faster than distance. If voxels are not cubes, steps are
/// shortened by the ratio of their edges, because the grid may have been scaled after its distances were computed. The
/// same holds for a grid whose values change faster than distance, and says so: metadata "largest_slope", a double.
/// @param relaxation  factor of the steps, 1 (plain) to below 2
/// Throws InputError for grids that requireTraceable() refuses. Keeps the grid.
std::unique_ptr<trace::Intersector> makeSphereIntersector(openvdb::FloatGrid::ConstPtr grid, double relaxation = 1.4);

}  // namespace stratum::march
