// One shape at several voxel sizes (levels of detail), selected by the distance from the eye.
//
// The composite surface depends on position and eye alone, so it is the same for all rays. At the distances where the
// voxel size changes it has steps, at most half a voxel of each level high, which are closed by walls.
#pragma once

#include "trace/intersector.h"

#include <memory>
#include <vector>

namespace stratum::trace {

struct DetailLevel {
    std::shared_ptr<const Intersector> shape;
    double from =
        0;  ///< distance from the eye, world units, where this level begins; it ends where the next one begins
};

/// `levels` from the finest and nearest, whose `from` is 0, outwards; 1 to 8. A level needs to be valid only in its
/// range of distances, plus its narrow band. A single level is returned unchanged. Voxel size is the finest's, the
/// surface offset the coarsest's, bounds are those of all levels together. Throws UsageError if there are no levels or
/// too many, or if their distances don't ascend from 0.
std::shared_ptr<const Intersector> makeDetailIntersector(std::vector<DetailLevel> levels, const glm::dvec3& eye);

}  // namespace stratum::trace
