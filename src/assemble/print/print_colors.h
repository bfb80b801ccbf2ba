// The colors of a print's filament, as its file states them.
#pragma once

#include "gcode/toolpath/color.h"
#include "gcode/toolpath/toolpath.h"
#include "march/file/level_set_file.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::assemble {

// A color a tool, as asked for, instead of those that a print's file states.

struct ToolColors {
    /// By tool, for gcode::ReadOptions::filament_colors; nothing: as the file states.
    std::vector<std::optional<gcode::Rgb>> colors;
    /// "#rrggbb" -> material, of filaments that are not plain plastic. Tools of one color share the first one's.
    std::map<std::string, std::string> finishes;
};

/// "NAME,NAME,...", tool 0 first; each as for shade::colorNamed(). An empty name leaves that tool's color as it is.
/// Throws UsageError, which begins with `option`, and InputError.
ToolColors toolColorsOf(std::string_view list, std::string_view option);

/// The colors that a file states for its print.
struct PrintColors {
    /// "#rrggbb", each once, in the order of first use. Empty: the file states none.
    std::vector<std::string> stated;
    bool some_unstated = false;  ///< parts of it have no stated color
    bool by_place = false;       ///< the color depends on the position
    /// "#rrggbb" -> material, of filaments whose names say that they are not plain plastic (shade::finishOfProfile()).
    /// Tools of one color share the first one's.
    std::map<std::string, std::string> finishes;
    nlohmann::ordered_json report = nlohmann::ordered_json::array();  ///< color and where it was found, for --stats
};

/// Of the selected beads, see gcode::statedColors().
/// @param asked  by tool: colors that were asked for instead of the file's, with their own finishes
PrintColors colorsOf(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                     std::span<const std::optional<gcode::Rgb>> asked = {});

/// Of a level set: a grid named "color" beside it, else the metadata "filament_color" of its own.
/// @param head  metadata of the level set
/// Throws InputError for a file that can't be read.
PrintColors colorsOf(const std::string& path, const openvdb::FloatGrid& head);

}  // namespace stratum::assemble
