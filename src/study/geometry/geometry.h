// How far the level set is from the beads that it was made of.
#pragma once

#include "study/geometry/exact_solid.h"
#include "study/study.h"

#include "trace/intersector.h"

#include <span>
#include <string>
#include <vector>

namespace stratum::study {

struct GeometryOptions {
    std::string print;           ///< a G-code file
    std::string layers;          ///< "A:B", see voxelize::parseLayers; empty: all
    std::vector<double> counts;  ///< voxels a layer, need not be whole; empty: 1, 2, 3, 4, 6, 8, or 1, 2, 4 if quick
    std::size_t points = 0;      ///< on the union's surface; 0: 40000, or 4000 if quick
};

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

/// geometry.csv and geometry.html: errors against voxel size, on lattices aligned with the layers and half a voxel off,
/// for several half-widths, as floats and halves, of the beads' union and of settled beads, each against its own exact
/// surface; and against run time. Both ways: from the exact surface to the level set, with the share of it that is not
/// there, and back. Level beads only. Throws InputError, UsageError, OutputError.
StudyReport studyGeometry(const GeometryOptions& options, const StudyOptions& common);

}  // namespace stratum::study
