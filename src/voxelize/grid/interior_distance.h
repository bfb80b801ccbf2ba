// Signed distances inside the solid as well, e.g. for offsetting or simulation.
#pragma once

#include <openvdb/openvdb.h>

namespace stratum::voxelize {

/// Of memory while it runs, for each leaf of the grid: OpenVDB's copy, masks and lists of its voxels; measured.
constexpr double kSweepBytesPerLeaf = 10e3;

/// Replaces the negative values, which are a bound, by distances to the surface: OpenVDB's fast sweeping from the zero
/// crossings. Voxels deeper than the background become inactive. Values outside don't change. Parallel. Throws
/// UsageError if memory is short. Work that is asked to stop (StopScope) ends within the sweep and leaves the grid
/// partly changed. (Zhao, Math. Comp. 74, 2005; openvdb/tools/FastSweeping.h)
void sweepInterior(openvdb::FloatGrid& grid);

}  // namespace stratum::voxelize
