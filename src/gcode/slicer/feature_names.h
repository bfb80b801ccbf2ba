// Maps each slicer's feature names to Feature.
//
// Sources: PrusaSlicer and SuperSlicer ExtrusionEntity.cpp (role names), OrcaSlicer and BambuStudio
// ExtrusionEntity.cpp, CuraEngine gcodeExport.cpp, Slic3r GCode.pm, IceSL's printer profiles, KISSlicer and CraftWare
// by GCodeProcessor.cpp's tags for them, Simplify3D, ideaMaker, Kiri:Moto
// and Miracle-Grue by their output.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <optional>
#include <string_view>

namespace stratum::gcode {

/// All functions ignore the case of `name`, which has no blanks around it, and return nullopt for an unknown one.
/// This one is for names behind ";TYPE:" or "; FEATURE:".
std::optional<Feature> featureOfType(std::string_view name);
/// For a whole comment, as Slic3r writes behind each move, Simplify3D and IceSL on a line of its own.
std::optional<Feature> featureOfBareName(std::string_view name);
/// For the comments of Miracle-Grue behind each move, "insets:" of its first version, and REALvision's before moves.
std::optional<Feature> featureOfMoveComment(std::string_view name);
/// For names behind CraftWare's ";segType:".
std::optional<Feature> featureOfSegment(std::string_view name);
/// For names in KISSlicer's "; 'Sparse Infill Path', ...", without " Path".
std::optional<Feature> featureOfPath(std::string_view name);

}  // namespace stratum::gcode
