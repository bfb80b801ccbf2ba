// One shape at two voxel sizes: rays that ask for an average over a wide lobe meet the coarse one, far from where they
// began. Nearby, where grooves between layers shade each other, all is as fine as for others.
#pragma once

#include "march/intersector.h"

#include <memory>

namespace stratum::march {

/// Rays with Ray::wide are answered by `coarse` from `distance` (world units, > 0) from their origin on. All others
/// never meet it, so wide should be those alone that are asked for whether, or where, they are stopped: a ray that goes
/// on from a place on the coarse surface may begin inside of the fine one. Bounds, voxel size and surface offset are
/// those of `fine`. Where both meet, nothing leaks (piecewise_tracer.h).
std::shared_ptr<const Intersector> makeWideIntersector(std::shared_ptr<const Intersector> fine,
                                                       std::shared_ptr<const Intersector> coarse, double distance);

}  // namespace stratum::march
