// Options of Python -> what reads and selects prints.
#pragma once

#include "python/options/keywords.h"

#include "gcode/reader.h"
#include "voxelize/grid/print_options.h"

namespace stratum::python {

/// plate, filament_diameter, filament_colors (a color a tool), tool_offsets, layer_height, belt, planar, e_mode,
/// firmware, planner, printer, beads, section, flow, flow_lag, pressure_advance, sag, crown, strings: as the tools'
/// options of those names. Throws UsageError, InputError.
gcode::ReadOptions readOptionsOf(Keywords& options);

/// voxel_size, voxels_per_layer, tolerance, memory_budget, half_width, layers, features, objects, tools. `pictures`:
/// voxel_size may be "auto". Leaves PrintOptions::read as it is. Throws UsageError.
voxelize::PrintOptions printOptionsOf(Keywords& options, bool pictures = false);
/// The selection alone.
void readSelection(Keywords& options, voxelize::PrintOptions& print);

}  // namespace stratum::python
