// Slicers' comments between moves: features, heights, layer and object boundaries.
// Sources: PrusaSlicer GCodeProcessor.cpp (";TYPE:", ";HEIGHT:", ";LAYER_CHANGE"; KISSlicer's and CraftWare's tags),
// BambuStudio and OrcaSlicer GCodeProcessor.cpp ("; FEATURE: ", "; LAYER_HEIGHT: ", "; CHANGE_LAYER"), CuraEngine
// gcodeExport.cpp (";LAYER:", ";TYPE:", ";MESH:"), Slic3r GCode.pm (inline comments), Skeinforge's "(<layer> 0.3 )",
// IceSL's printer profiles, Simplify3D, ideaMaker and Kiri:Moto by their output.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <optional>
#include <string_view>

namespace stratum::gcode {

/// One comment's meaning. Views point into the comment.
struct Tag {
    enum class Kind : std::uint8_t {
        none,
        feature,
        height,
        layer_change,
        object_start,
        object_stop,
        color_change,
        filament_loaded,  ///< behind a change of tool: what was drawn back is at the nozzle again
        flush_start,      ///< E in place pushes the old filament out (BambuStudio, OrcaSlicer)
        flush_stop,
        units_set,  ///< the first line of the slicer's own behind the start program
    };
    Kind kind = Kind::none;
    Feature feature = Feature::unknown;  ///< of Kind::feature; unknown if the name in `text` is unknown
    double height = 0;                   ///< mm, of Kind::height; of a layer change that names its height, else 0
    std::optional<double> z{};           ///< mm, of a layer change that names its z
    std::string_view text{};  ///< the feature's or object's name as written (also where an object ends); a new color as
                              ///< "#RRGGBB"; the words that mark a layer, which tell slicers' marks from each other
    int tool = -1;            ///< of a color change; -1 is the current tool
    bool bare = false;        ///< a feature's name alone, as Slic3r writes it behind each of its moves
    bool raft = false;        ///< of a layer change: the layer is below the part (Cura's ";LAYER:-2")
};

/// How an object begins that is marked by its number alone.
inline constexpr std::string_view kObjectNumber = "unique label id: ";

/// The tag in a comment (given without its ';'), or Kind::none. ";WIDTH:" is none of them: the width follows from E.
Tag parseTag(std::string_view comment);

/// "layer 3" or "layer", as people's own programs have it; parseTag() has none of it.
bool isPlainLayerMark(std::string_view comment);

}  // namespace stratum::gcode
