// Signed distances inside the solid as well, e.g. for offsetting or simulation.
#pragma once

#include <openvdb/openvdb.h>

namespace stratum::voxelize {

/// Replaces the negative values, which are a bound, by distances to the surface: OpenVDB's fast sweeping from the zero
/// crossings. Voxels deeper than the background become inactive. Values outside don't change. Parallel; needs the
/// memory of a second grid meanwhile. Work that is asked to stop (StopScope) ends within the sweep and leaves the grid
/// partly changed. (Zhao, Math. Comp. 74, 2005; openvdb/tools/FastSweeping.h)
void sweepInterior(openvdb::FloatGrid& grid);

}  // namespace stratum::voxelize
