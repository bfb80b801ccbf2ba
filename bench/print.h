// What every measurement of the voxelizer starts from: a print and a lattice for it.
#pragma once

#include "gcode/toolpath.h"
#include "voxelize/lattice.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace stratum::bench {

/// Reads a G-code file. Throws InputError.
gcode::Toolpath readPrint(const std::string& path);

/// The lattice that `gcode2vdb --voxel-size` chooses; `voxel_size` in mm.
voxelize::Lattice latticeOf(const gcode::Toolpath& toolpath, const std::vector<std::uint32_t>& beads,
                            double voxel_size);

/// Seconds; `cpu` of all threads.
struct Times {
    double wall = 0, cpu = 0;
};

Times timesOf(const std::function<void()>& work);

}  // namespace stratum::bench
