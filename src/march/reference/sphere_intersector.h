// Sphere tracing of the trilinear field: the classic to compare with.
//
// J. C. Hart, "Sphere Tracing" (The Visual Computer 12, 1996); over-relaxed as in B. Keinert et al., "Enhanced Sphere
// Tracing" (STAG 2014). Empty nodes of the tree are left in one step.
#pragma once

#include "trace/intersector.h"

#include <openvdb/openvdb.h>

#include <memory>

namespace stratum::march {

/// Hits are within a thousandth of a voxel of the surface along the field, and farther along rays that graze. Where
/// rays creep along a surface the steps shrink with the distance: a ray that has not arrived after 2000 of them is
/// given up as a miss. Thin features between two steps can be jumped over, since the trilinear field may change faster
/// than distance. Where voxels are no cubes, steps are shortened by the ratio of their edges: their grid may have been
/// stretched after its distances were computed.
/// @param relaxation  factor of the steps, 1 (plain) to below 2
/// Throws InputError for grids that requireTraceable() refuses. Keeps the grid.
std::unique_ptr<trace::Intersector> makeSphereIntersector(openvdb::FloatGrid::ConstPtr grid, double relaxation = 1.4);

}  // namespace stratum::march
