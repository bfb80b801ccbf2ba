// The color of a bead's filament: that of the tool, as the file states it, until a manual change of filament. Where a
// print has several filaments, those without a stated color have one of a palette.
//
// Sources: PrusaSlicer, OrcaSlicer and BambuStudio ("; filament_colour =", ";COLOR_CHANGE,T0,#RRGGBB").
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace stratum::gcode {

/// A color of filament, and where the file states it.
struct StatedColor {
    std::optional<Rgb> color;  ///< sRGB; nullopt if the file states none
    std::uint8_t tool = 0;
    bool changed = false;  ///< by a manual change of filament; else the tool's color in the settings
    bool palette = false;  ///< the file states none: one of kCategoryColors, so that tools can be told apart
};

/// Gives tools that print, and changes of filament, a color of kCategoryColors if the file states none for them and
/// there are several: tool n has the one that --color-by tool shows. One filament without a color stays without.
void colorUnstated(Toolpath& toolpath);

/// That of a tool, without changes of filament.
StatedColor colorOfTool(const Toolpath& toolpath, std::uint8_t tool);

/// That of `toolpath.beads[bead]`.
StatedColor statedColorOf(const Toolpath& toolpath, std::size_t bead);

/// Those of the selected beads, each color once, with the statement of its first use, in that order. `selection` has
/// indices into `toolpath.beads`.
std::vector<StatedColor> statedColors(const Toolpath& toolpath, std::span<const std::uint32_t> selection);

/// sRGB of the filament of `toolpath.beads[bead]`; nullopt where the file states no color for its tool.
std::optional<Rgb> colorOf(const Toolpath& toolpath, std::size_t bead);

/// The colors alone.
std::vector<std::optional<Rgb>> distinctColors(const Toolpath& toolpath, std::span<const std::uint32_t> selection);

}  // namespace stratum::gcode
