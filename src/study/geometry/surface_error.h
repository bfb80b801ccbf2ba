// How far a level set is from the beads that it was made of.
#pragma once

#include "study/geometry/exact_solid.h"
#include "trace/intersector.h"

#include <span>
#include <vector>

namespace stratum::study {

/// Spread of what was measured at many points.
struct Spread {
    double mean = 0, rms = 0, p999 = 0, max = 0;
};
/// 0 for no values.
Spread spreadOf(std::vector<double> values);

/// What points on the exact surface see of the level set.
struct SurfaceError {
    Spread distance;        ///< mm, to the nearest zero of the trilinear field that was found
    Spread angle;           ///< degrees, between the normals there
    double lost_share = 0;  ///< of the points that have no zero within `search`
};

/// For each point the nearest zero of the trilinear field: along the normal, both ways, and along 24 more directions,
/// then towards its foot point in three steps. An upper bound of the distance; exact where the surface is smooth.
/// Parallel. @param search  how far zeros are looked for, mm
SurfaceError surfaceError(const trace::Intersector& level_set, std::span<const ExactSolid::SurfacePoint> points,
                          double search);

/// The way back: absolute distances of the union at the hits of rays from outside, mm.
Spread backwardError(const trace::Intersector& level_set, const ExactSolid& exact, std::size_t rays);

}  // namespace stratum::study
