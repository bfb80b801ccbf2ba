// Writes a toolpath as CSV, for inspection, plots and comparison with other readers.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <filesystem>

namespace stratum::gcode {

/// Writes one row a bead, in print order, whole or not at all. Columns (mm, mm/s, mm^3, radians):
/// line,layer,feature,tool,object,x0,y0,z0,x1,y1,z1,center_x,center_y,sweep,width,height,length,volume,speed
/// Straight beads leave the three arc columns empty. Throws OutputError.
void writeToolpathCsv(const Toolpath& toolpath, const std::filesystem::path& path);

}  // namespace stratum::gcode
