// Signed distances inside the solid too, for those who offset or simulate.
#pragma once

#include <openvdb/openvdb.h>

namespace stratum::voxelize {

/// Replaces the negative values, which are a bound, by distances to the surface: OpenVDB's fast sweeping from the zero
/// crossings. What lies deeper than the background becomes inactive. Values outside stay as they are. Parallel; takes
/// another grid's memory while it works. (Zhao, Math. Comp. 74, 2005; openvdb/tools/FastSweeping.h)
void sweepInterior(openvdb::FloatGrid& grid);

}  // namespace stratum::voxelize
