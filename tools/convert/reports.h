// What of a conversion --stats and the terminal tell.
#pragma once

#include "deposit/lay_flow.h"
#include "deposit/sag.h"
#include "export/mesh/surface_mesh.h"
#include "export/vdb_stream.h"
#include "gcode/printer/limit_origins.h"
#include "gcode/toolpath/stated.h"
#include "gcode/toolpath/toolpath.h"
#include "motion/print_times.h"
#include "voxelize/beads/lattice.h"
#include "voxelize/grid/voxelizer.h"

#include <openvdb/openvdb.h>
#include <nlohmann/json.hpp>

#include <optional>
#include <string>

namespace stratum::tools {

// The part of --stats that is about the G-code.

/// Counts and sums; what each feature, tool and object takes; whose rules the file was read by, and why; the warnings.
nlohmann::ordered_json describeToolpath(const gcode::Toolpath& toolpath);

/// What flows out of the nozzle.
nlohmann::ordered_json describeFlow(const deposit::FlowReport& flow);
/// The same in a line of text.
std::string flowLine(const deposit::FlowReport& flow);
/// What hangs over nothing.
nlohmann::ordered_json describeSag(const deposit::SagReport& sag);
std::string sagLine(const deposit::SagReport& sag);

// The part of reports that is about how long a print takes.

/// {planned_s, stated_s, rule, limits, ...}; stated_s is the time of the printing alone where the slicer tells it
/// apart, and null where the file is silent. It is compared with `estimate`, if there is one: motion::estimatedTimes().
nlohmann::ordered_json describeTimes(const motion::PrintTimes& times, const std::optional<motion::PrintTimes>& estimate,
                                     const gcode::StatedFacts& stated);

/// The same as lines of text, each with its line end.
std::string timeLines(const motion::PrintTimes& times, const std::optional<motion::PrintTimes>& estimate,
                      const gcode::StatedFacts& stated);

// The part of reports that is about the limits of the machine: their values, and where each is from.

/// [{name, value, unit, from, changes, first_change}, ...] of the limits that the rule reads; a null value: no limit.
nlohmann::ordered_json describeLimits(const gcode::LimitOrigins& limits);

/// The same as lines of text, each with its line end. Axes whose limits are from one place share a line.
std::string limitLines(const gcode::LimitOrigins& limits);

// What --stats says of a level set and of its mesh, and whether the level set holds what was extruded.

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
