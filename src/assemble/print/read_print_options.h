// The options of a print, as a command line or Python gives them.
#pragma once

#include "base/options/option_source.h"
#include "gcode/printer/read_options.h"
#include "voxelize/grid/print_options.h"

namespace stratum::assemble {

// All throw what the source throws, and UsageError.

/// How its file is read and what the printer makes of it: plate, filament_diameter, filament_colors, tool_offsets,
/// layer_height, belt, planar, e_mode, firmware, planner, printer, beads, section, flow, flow_lag, pressure_advance,
/// sag, crown, strings. Fills in PrintOptions::read and printer. Throws InputError, too.
void readReading(OptionSource& options, voxelize::PrintOptions& print);

/// Which beads: layers, features, objects, tools.
void readSelection(OptionSource& options, voxelize::PrintOptions& print);

/// Which voxels: voxel_size, voxels_per_layer, tolerance, memory_budget, half_width.
/// @param pictures  voxel_size may be "auto"
void readLattice(OptionSource& options, voxelize::PrintOptions& print, bool pictures = false);

/// Both, beads and voxels.
void readConversion(OptionSource& options, voxelize::PrintOptions& print, bool pictures = false);

}  // namespace stratum::assemble
