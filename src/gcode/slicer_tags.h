// What slicers say in comments while printing: features, heights, layer and object boundaries.
// Sources: PrusaSlicer GCodeProcessor.cpp (";TYPE:", ";HEIGHT:", ";LAYER_CHANGE"), CuraEngine gcodeExport.cpp
// (";LAYER:", ";TYPE:", ";MESH:"), Slic3r GCode.pm (inline comments), Simplify3D and ideaMaker by their output.
#pragma once

#include "gcode/toolpath.h"

#include <optional>
#include <string_view>

namespace stratum::gcode {

/// One comment's meaning. Views point into the comment.
struct Tag {
    enum class Kind : std::uint8_t { none, feature, height, layer_change, object_start, object_stop };
    Kind kind = Kind::none;
    Feature feature = Feature::unknown;  ///< of Kind::feature; unknown if `text` is no name that is known here
    double height = 0;                   ///< mm, of Kind::height; of a layer change that names its height, else 0
    std::optional<double> z{};           ///< mm, of a layer change that names its z
    std::string_view text{};             ///< the feature's or object's name as written
};

/// The tag in a comment (given without its ';'), or Kind::none. ";WIDTH:" is none of them: the width follows from E.
Tag parseTag(std::string_view comment);

/// The feature of a slicer's name for it, whatever its case; nullopt if unknown.
std::optional<Feature> featureOfSlicerName(std::string_view name);

}  // namespace stratum::gcode
