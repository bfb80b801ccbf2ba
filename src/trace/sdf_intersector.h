// Sphere tracing of analytic signed distance functions, in double precision.
#pragma once

#include "trace/intersector.h"
#include "trace/sdf.h"

#include <memory>

namespace stratum::trace {

/// A hit is a change of sign, refined to the precision of the coordinates; the normal is the gradient by central
/// differences. `tolerance` (world units, > 0) is the shortest step, used where the distance is smaller. Only parts
/// that are thinner than that along a ray can be missed. A ray counts as a miss after 100 000 steps or 10^5 world
/// units. voxelSize() is the tolerance. Throws UsageError.
std::unique_ptr<Intersector> makeSdfIntersector(SdfPtr shape, double tolerance = 1e-4);

}  // namespace stratum::trace
