// LayerStack -> FloatGrid: the level set of the part as printed.
#pragma once

#include "gcode/toolpath.h"
#include "voxelize/lattice.h"

#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

namespace stratum::voxelize {

/// From print space to the grid's world space: world = unit * (print + offset).
struct Placement {
    double unit = 1;               ///< world units a mm: 1 for mm, 0.1 for cm, 0.001 for m
    double offset[3] = {0, 0, 0};  ///< mm
};

struct VoxelizeOptions {
    Placement placement;
    /// Refuse before building if the estimate is larger, bytes. 0: 90 % of what the machine has available.
    std::size_t memory_limit = 0;
    /// Called now and then with the fraction done, 0..1, from any of the working threads, one call at a time.
    std::function<void(double)> progress;
};

/// Builds the narrow-band level set of the union of the selected beads (indices into toolpath.beads, ascending).
///
/// Values outside the solid are signed distances to the union, exact to float rounding; inside they are negative
/// everywhere (layers are welded) but a bound, not a distance. Active voxels are those within the half-width; inactive
/// voxels and tiles hold plus or minus the background. Every voxel's sign is set: a signed flood fill changes nothing.
/// Parallel through TBB; the result does not depend on the number of threads. Throws UsageError with the estimate if
/// the grid would not fit.
openvdb::FloatGrid::Ptr voxelize(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                                 const Lattice& lattice, const VoxelizeOptions& options = {});

/// Volume inside the zero level in world units cubed, each voxel counted by its share of inside. Parallel.
double enclosedVolume(const openvdb::FloatGrid& grid);

}  // namespace stratum::voxelize
