// Shapes by formula, traced as they are: sphere tracing in double precision.
#pragma once

#include "trace/intersector.h"
#include "trace/sdf.h"

#include <memory>

namespace stratum::trace {

/// A hit is where the sign changes, refined to the rounding of the coordinates; the normal is the gradient by central
/// differences. `tolerance` (world units, > 0) is the shortest step: near a surface, where the distance is less than
/// that, rays go on by so much. What is thinner along a ray, or enters a surface no deeper between two such steps, can
/// be missed; nothing else is. A ray is given up as a miss after 100 000 steps or 10^5 world units. voxelSize() is the
/// tolerance. Throws UsageError.
std::unique_ptr<Intersector> makeSdfIntersector(SdfPtr shape, double tolerance = 1e-4);

}  // namespace stratum::trace
