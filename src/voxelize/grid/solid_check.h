// Checks whether a lattice is fine enough for the solid of the beads, without a grid or with a few leaves of it.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/lattice.h"

#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace stratum::voxelize {

// Volume of the solid that a level set encloses.

/// Volume where the trilinear field is negative, world units cubed. Only signs and zero crossings are used, because
/// values inside need not be distances: a cell of eight negative samples is solid; the share of a mixed one is found
/// from the zero crossings of four lines along z. Half-widths of 2 voxels or more. In grids with more leaves than
/// `most_leaves`, a sample of about that many, chosen by a hash of their number, is used. Parallel; the same value for
/// any number of threads.
double enclosedVolume(const openvdb::FloatGrid& grid,
                      std::size_t most_leaves = std::numeric_limits<std::size_t>::max());

/// Leaves that give the volume of a print to about one per cent, in less than 0.1 s.
constexpr std::size_t kVolumeSample = 8192;

// Volume inside the cells of one leaf, and which leaves a sample takes.

/// A leaf's samples, by x, y and z, and the next ones along each axis.
struct LeafSamples {
    static constexpr int kEdge = 9;
    float v[kEdge][kEdge][kEdge];
};

/// Voxels of the first edge x edge x 8 cells that are inside. A cell of eight negative samples is solid; the share of a
/// mixed one is found from the zero crossings of four lines along z.
double insideCells(const LeafSamples& leaf, int edge);

/// A hash (splitmix64's last step): leaves are in a regular order, and every n-th would be a biased sample.
std::uint64_t scattered(std::uint64_t n);

/// Share (0..1) of the beads whose middle is not solid on the lattice: the field of the union, exact at the eight
/// samples around it and trilinear between them, is not negative there. Tests at most 512 beads: 32 consecutive ones at
/// 16 positions along the print. So a share of a few per cent is accurate to a few per cent. Only beads near those are
/// evaluated. `selection` ascending, not empty.
double lostShare(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection, const Lattice& lattice);

/// Volume of the beads of `selection` without overlaps: lengths times section areas, mm^3.
double depositedVolume(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection);

/// Relative difference of the enclosed from the deposited volume above which a report should mention it. Beads
/// overlap where they cross and turn, and gaps narrower than a voxel are filled: see docs/level_set.md for real prints.
constexpr double kVolumeDoubt = 0.15;

}  // namespace stratum::voxelize
