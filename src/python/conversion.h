// What Python makes of a toolpath by the choices of gcode2vdb.
#pragma once

#include "python/long_call.h"
#include "python/options/keywords.h"
#include "python/toolpath_object.h"

#include "export/plan/level_set_plan.h"
#include "export/vdb_file.h"

#include <openvdb/openvdb.h>

#include <filesystem>
#include <span>

namespace stratum::python {

/// assemble::readConversion() and interior, interior_distance, grids, unit, up, origin. Throws UsageError.
exporter::LevelSetChoices levelSetChoicesOf(Keywords& options);

/// Throws UsageError if one of them needs times and there are none.
void requireTimes(const gcode::Toolpath& toolpath, std::span<const voxelize::Attribute> attributes);

/// The level set first, then the attributes, with the metadata of gcode2vdb. Needs no GIL. Throws UsageError,
/// InputError.
openvdb::GridPtrVec makeGrids(const ToolpathObject& print, const exporter::LevelSetPlan& plan, const Report& report);
/// Writes the file that gcode2vdb writes; what needs no grid goes to the disk while it is made. Needs no GIL. Throws
/// UsageError, InputError, OutputError.
void writePrint(const ToolpathObject& print, const exporter::LevelSetPlan& plan, const std::filesystem::path& path,
                const exporter::FileOptions& file, const Report& report);

}  // namespace stratum::python
