// What a person wants to know about a toolpath, as a few lines of text.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace stratum::gcode {

/// Of one feature or object: what lies under its name.
struct FeatureTotal {
    std::size_t beads = 0;
    double length = 0;  ///< mm
    double volume = 0;  ///< mm^3
};

/// By Feature.
std::array<FeatureTotal, kFeatureCount> featureTotals(const Toolpath& toolpath);

/// By index into Toolpath::objects; [0] is what belongs to none.
std::vector<FeatureTotal> objectTotals(const Toolpath& toolpath);

/// What the file states (time, weight, material, nozzle, printer, layer heights); slicer, container and firmware rules
/// with their reason; layers, beads, length, volume; filament per tool beside what the file itself says; features;
/// objects; warnings with count and first line. Ends with a line end.
std::string summarize(const Toolpath& toolpath);

}  // namespace stratum::gcode
