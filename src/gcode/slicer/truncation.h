// Detects truncated programs by the trailer that their slicer writes.
//
// Sources: the trailers that the slicers write: the config block of PrusaSlicer and its kin (GCode.cpp), BambuStudio's
// EXECUTABLE_BLOCK_END, Cura's ";End of Gcode", the summaries of Simplify3D, ideaMaker and Kiri:Moto.
#pragma once

#include <string>
#include <string_view>

namespace stratum::gcode {

/// Why the bytes seem truncated, e.g. "the last line has no end"; empty if they don't. `slicer` is the name in the
/// program's header; for unknown slicers only the last line is checked.
std::string findCut(std::string_view bytes, std::string_view slicer);

}  // namespace stratum::gcode
