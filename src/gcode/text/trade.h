// What a program without extrusion is: for messages to a person who gave the wrong file.
#pragma once

#include <string>
#include <string_view>

namespace stratum::gcode {

/// What kind of program it is, as the end of a sentence that begins with "this is"; empty if it can't be told. Knows
/// templates with placeholders of a slicer, and programs of lasers, mills and pen plotters. Reads the first 256 KB.
/// Sources: grbl (M3, M4 and S of lasers), NIST RS274/NGC (G43, G81 to G89, M6), PrusaSlicer's and Cura's placeholders.
std::string describeTrade(std::string_view bytes);

}  // namespace stratum::gcode
