// The lattice of voxels: size and origin, with voxel planes on layer planes.
//
// Sampling a stack of beads on planes that miss the layer planes has an error of 0.42 voxel at every resolution; on
// them the error falls with the voxel size. So the voxel size is the layer height over a whole number, and the z origin
// is on a layer plane. With one voxel a layer or fewer every sample would then lie where two layers touch, and none
// inside a bead: then the planes are shifted by half a voxel.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/beads/estimate.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace stratum::voxelize {

/// The user's request; at most one of voxel_size and voxels_per_layer.
struct LatticeRequest {
    std::optional<double> voxel_size;       ///< mm
    std::optional<int> voxels_per_layer;    ///< 1..64
    double half_width = 3;                  ///< voxels, 1..10; OpenVDB's tools expect 3
    double pixel = 0;                       ///< mm that a pixel of the picture spans at least; 0: not known
    std::size_t memory = 0;                 ///< bytes that a grid of the default size may take; 0: availableMemory()
    double bytes_per_leaf = kBytesPerLeaf;  ///< of that grid and of what is made beside it
};

/// Sample (i, j, k) lies at (i, j, k) * voxel_size + (0, 0, origin_z) in print space.
struct Lattice {
    double voxel_size = 0;     ///< mm
    double origin_z = 0;       ///< mm
    double half_width = 3;     ///< voxels
    double layer_height = 0;   ///< mm, of most of the printed length
    double aligned_share = 0;  ///< share of the level beads' length whose bottom and top lie on voxel planes, 0..1
    std::string reason;        ///< how the voxel size was chosen, for the report
    std::string warning;       ///< which parts of the print are lost at this voxel size; usually empty

    /// The background value, mm. Slightly above the half-width: OpenVDB's checks divide it by the voxel size in floats,
    /// and the quotient must not be less than the half-width.
    double background() const { return half_width * voxel_size * (1 + 1e-6); }
};

/// Chooses the lattice for the beads of `selection`, whose solid has the box `bounds`. Without a request: the finest of
/// four, three and two voxels a layer that stays below about 60 million active voxels and half of the memory; up to
/// eight instead of four if a voxel would be longer than two pixels, so that small prints and close views don't look
/// faceted. Throws UsageError for sizes that are not positive numbers, larger than the part, or too fine to index.
Lattice chooseLattice(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection, const Bounds& bounds,
                      const LatticeRequest& request);

}  // namespace stratum::voxelize
