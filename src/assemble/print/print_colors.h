// Which colours a print's filament has, by its own file.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "march/file/level_set_file.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace stratum::assemble {

/// What a file says of the colours of what it shows.
struct PrintColors {
    /// "#rrggbb", each once, in the order of first use. Empty: the file says nothing.
    std::vector<std::string> stated;
    bool some_unstated = false;                                       ///< parts of it have no stated colour
    bool by_place = false;                                            ///< which one it is must be asked at each place
    nlohmann::ordered_json report = nlohmann::ordered_json::array();  ///< color and where it was found, for --stats
};

/// Of the selected beads: their tools' colours by the file's settings, and changes by hand.
PrintColors colorsOf(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection);

/// Of a level set: a grid named "color" beside it, else the metadata "filament_color" of its own.
/// @param head  metadata of the level set
/// Throws InputError for a file that can't be read.
PrintColors colorsOf(const std::string& path, const openvdb::FloatGrid& head);

}  // namespace stratum::assemble
