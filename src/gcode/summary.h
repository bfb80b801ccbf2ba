// A summary of a toolpath in a few lines of text.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace stratum::gcode {

/// Totals of one feature or object.
struct FeatureTotal {
    std::size_t beads = 0;
    double length = 0;  ///< mm
    double volume = 0;  ///< mm^3
};

/// By Feature.
std::array<FeatureTotal, kFeatureCount> featureTotals(const Toolpath& toolpath);

/// By index into Toolpath::objects; [0] are beads without an object.
std::vector<FeatureTotal> objectTotals(const Toolpath& toolpath);

/// Seconds by layer number: beads, and what the machine does before each of them. What comes before the first bead
/// isn't counted. By Toolpath::timing; without it, extruding at the programmed speeds.
std::vector<double> layerSeconds(const Toolpath& toolpath);

/// Statements of the file (time, weight, material, nozzle, printer, layer heights); slicer, container and firmware
/// rules with their reason; layers, beads, length, volume; filament read and stated, prime lines apart, by tool;
/// features; objects; warnings with count and first line. Ends with a newline.
std::string summarize(const Toolpath& toolpath);

}  // namespace stratum::gcode
