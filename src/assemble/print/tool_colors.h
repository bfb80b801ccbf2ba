// A color a tool, as asked for, instead of those that a print's file states.
#pragma once

#include "gcode/toolpath/color.h"

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::assemble {

struct ToolColors {
    /// By tool, for gcode::ReadOptions::filament_colors; nothing: as the file states.
    std::vector<std::optional<gcode::Rgb>> colors;
    /// "#rrggbb" -> material, of filaments that are not plain plastic. Tools of one color share the first one's.
    std::map<std::string, std::string> finishes;
};

/// "NAME,NAME,...", tool 0 first; each as for shade::colorNamed(). An empty name leaves that tool's color as it is.
/// Throws UsageError, which begins with `option`, and InputError.
ToolColors toolColorsOf(std::string_view list, std::string_view option);

}  // namespace stratum::assemble
