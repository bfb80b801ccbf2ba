// What --stats says of a level set and of its mesh, and whether the level set holds what was extruded.
#pragma once

#include "export/mesh/surface_mesh.h"
#include "export/vdb_stream.h"
#include "voxelize/beads/lattice.h"
#include "voxelize/grid/voxelizer.h"

#include <openvdb/openvdb.h>
#include <nlohmann/json.hpp>

#include <string>

namespace stratum::tools {

/// A level set in numbers, whether it was in memory or went to the disk leaf by leaf.
struct GridNumbers {
    exporter::WrittenGrid counted;
    openvdb::math::Transform::ConstPtr transform;
    double enclosed_mm3 = 0;             ///< volume inside
    std::size_t enclosed_of_leaves = 0;  ///< that it was measured in
    double deposited_mm3 = 0;            ///< volume of the beads
};
GridNumbers numbersOf(const openvdb::FloatGrid& grid);

/// The grid's section.
nlohmann::ordered_json describeGrid(const GridNumbers& grid, const voxelize::Lattice& lattice);
/// What --interior cull would save of it: floods it.
nlohmann::ordered_json describeCull(const voxelize::Voxelizer& voxelizer, const openvdb::FloatGrid& grid);
/// What of the beads their layers have room for; `surface_mm3` is what the level set encloses.
nlohmann::ordered_json describeDeposit(const gcode::DepositModel& deposit, const voxelize::DepositBalance& balance,
                                       double surface_mm3);
/// The same in lines of text, each with its line end.
std::string depositLines(const voxelize::DepositBalance& balance);
nlohmann::ordered_json describeMesh(const exporter::SurfaceMesh& mesh, const openvdb::FloatGrid& grid,
                                    const voxelize::Lattice& lattice);

/// The volume that the grid encloses, mm^3; of a sample of its leaves if they are many (see voxelize::kVolumeSample)
/// and it need not be exact.
double enclosedMm3(const openvdb::FloatGrid& grid, const voxelize::Lattice& lattice, bool exact = false);

/// A sentence if a level set holds clearly less or more than was extruded; empty if all is well. What culling fills is
/// solid, so of a culled grid only too little can be told.
std::string doubtOf(double enclosed_mm3, double deposited_mm3, bool culled);

}  // namespace stratum::tools
