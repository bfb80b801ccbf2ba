// What a level set is, for gcode2vdb --stats.
#pragma once

#include "voxelize/lattice.h"
#include "voxelize/surface_mesh.h"
#include "voxelize/voxelizer.h"

#include <openvdb/openvdb.h>
#include <nlohmann/json.hpp>

namespace stratum::tools {

nlohmann::ordered_json describeGrid(const openvdb::FloatGrid& grid, const voxelize::Lattice& lattice);

/// What --interior cull would have left of it.
nlohmann::ordered_json describeCull(const voxelize::Voxelizer& voxelizer, const openvdb::FloatGrid& grid);

nlohmann::ordered_json describeMesh(const voxelize::SurfaceMesh& mesh, const openvdb::FloatGrid& grid,
                                    const voxelize::Lattice& lattice);

}  // namespace stratum::tools
