// What every measurement starts from: a print, and a lattice for it.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/lattice.h"

#include <cstdint>
#include <string>
#include <vector>

namespace stratum::study {

/// Reads a G-code file. Throws InputError.
gcode::Toolpath readPrint(const std::string& path);

/// The lattice that `gcode2vdb --voxel-size` chooses; `voxel_size` in mm.
voxelize::Lattice latticeOf(const gcode::Toolpath& toolpath, const std::vector<std::uint32_t>& beads,
                            double voxel_size);

/// The one that `gcode2vdb --voxels-per-layer` chooses.
voxelize::Lattice latticeOf(const gcode::Toolpath& toolpath, const std::vector<std::uint32_t>& beads,
                            int voxels_per_layer);

/// The first 12 digits of a file's SHA-256: tells whether rows of an earlier run are of the same file.
std::string shortHash(const std::string& path);

}  // namespace stratum::study
