// What swell_field.h adds to a layer, in SIMD: between nodes, at the points of a column. See leaf_kernels.h for what a
// column is and why all instruction sets give the same bytes.
#pragma once

#include "voxelize/leaf/leaf_kernels.h"

#include <span>

namespace stratum::voxelize {

/// The way from each node to the next along one axis: ramps[n] is nodeShare() of how far a point is past node n, 0
/// before it and 1 from the next one on. `q` is of a ColumnGrid; its points are q * per_unit + first nodes past node 0.
void nodeRamps(const PlanField& q, float per_unit, float first, std::span<PlanField> ramps);

/// Values between the nodes of a window, times `scale`. `nodes`: row by row along y, one more of each than ramps; what
/// they hold afterwards is of no use.
void betweenNodes(std::span<const PlanField> ramps_x, std::span<const PlanField> ramps_y, std::span<float> nodes,
                  float scale, PlanField& values);

/// rise = rise - share * crownDepth(crown, radius, nearest).
void lowerByCrown(const PlanField& share, const PlanField& nearest, float crown, float radius, PlanField& rise);

}  // namespace stratum::voxelize
