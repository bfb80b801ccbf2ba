// One shape at several voxel sizes: which of them answers follows from the distance to the eye.
//
// The composite is a function of position and eye alone, so all rays, wherever they come from, meet the same surface.
// At the distances where the voxel size changes it has steps as high as the surfaces of both differ, half a voxel of
// each at most, closed by walls (piecewise_tracer.h).
#pragma once

#include "trace/intersector.h"

#include <memory>
#include <vector>

namespace stratum::trace {

struct DetailLevel {
    std::shared_ptr<const Intersector> shape;
    double from = 0;  ///< distance from the eye, world units, from which on it answers, as far as the next level's
};

/// `levels` from the finest and nearest, whose `from` is 0, outwards; 1 to 8. A level needs to be right only as far as
/// it answers, and its narrow band beyond. A single level is returned as it is: nothing is added to it. Voxel size is
/// the finest's, the surface offset the coarsest's, bounds are those of all levels together. Throws UsageError if there
/// are no levels or too many, or if their distances don't ascend from 0.
std::shared_ptr<const Intersector> makeDetailIntersector(std::vector<DetailLevel> levels, const glm::dvec3& eye);

}  // namespace stratum::trace
