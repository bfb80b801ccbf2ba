// Metadata beside the G-code in a zip container.
//
// Sources: BambuStudio and OrcaSlicer, bbs_3mf.cpp ("Metadata/slice_info.config": a plate's prediction, weight,
// objects and filaments); Cura's UFPWriter ("/3D/_rels/model.gcode.rels" names the materials, *.xml.fdm_material).
#pragma once

#include "gcode/toolpath/color.h"
#include "gcode/toolpath/stated.h"

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stratum::gcode {

/// Empty where the container states nothing. Used only where the text states nothing.
struct PackageFacts {
    StatedFacts stated;
    std::vector<std::optional<Rgb>> filament_colors;                  ///< by tool
    std::vector<std::pair<std::string, std::string>> object_names{};  ///< by the number that labels it in the text
};

/// Of plate number `plate` in a slice_info.config. Never throws for invalid contents.
PackageFacts readSliceInfo(std::string_view xml, int plate);

/// The paths of the materials that a UFP's /3D/_rels/model.gcode.rels names, in its order, without the first '/'.
std::vector<std::string> materialPaths(std::string_view xml);

/// A material (*.xml.fdm_material).
struct Material {
    std::string name;  ///< 200 bytes at most
    std::optional<Rgb> color;
};
Material readMaterial(std::string_view xml);

}  // namespace stratum::gcode
