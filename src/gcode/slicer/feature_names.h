// What each slicer calls the parts of a print, in this project's one vocabulary.
//
// Sources: PrusaSlicer and SuperSlicer ExtrusionEntity.cpp (role names), OrcaSlicer and BambuStudio
// ExtrusionEntity.cpp, CuraEngine gcodeExport.cpp, Slic3r GCode.pm, IceSL's printer profiles, KISSlicer and CraftWare
// by GCodeProcessor.cpp's tags for them, Simplify3D, ideaMaker and Kiri:Moto by their output.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <optional>
#include <string_view>

namespace stratum::gcode {

/// All of them: whatever the case of `name`, without blanks around it; nullopt if it isn't known. Behind ";TYPE:" or
/// "; FEATURE:".
std::optional<Feature> featureOfType(std::string_view name);
/// A whole comment, as Slic3r writes behind each move, Simplify3D and IceSL on a line of its own.
std::optional<Feature> featureOfBareName(std::string_view name);
/// Behind CraftWare's ";segType:".
std::optional<Feature> featureOfSegment(std::string_view name);
/// In KISSlicer's "; 'Sparse Infill Path', ...", without " Path".
std::optional<Feature> featureOfPath(std::string_view name);

}  // namespace stratum::gcode
