// The color of a bead's filament: that of the tool, as the file states it, until a manual change of filament. Where a
// print has several filaments, those without a stated color have one of a palette.
//
// Sources: PrusaSlicer, OrcaSlicer and BambuStudio ("; filament_colour =", ";COLOR_CHANGE,T0,#RRGGBB").
#pragma once

#include "gcode/printer/mixer.h"
#include "gcode/toolpath/toolpath.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace stratum::gcode {

// The color of a mix of filaments.

/// Red, green and blue each as a band of light by the theory of Kubelka and Munk with one constant: of a mix, the ratio
/// of absorption to scattering, K/S = (1 - R)^2 / 2R of the linear reflectance R, is the mean of its parts' ratios.
/// Unlike a mean of colors, yellow and cyan make green. Each R is taken to be in [0.003, 0.997].
/// Sources: P. Kubelka, F. Munk, Z. techn. Physik 12 (1931); D. R. Duncan, Proc. Phys. Soc. 52 (1940) for mixes.
/// @param shares  of the colors, >= 0, with a sum of 1
Rgb mixedColor(std::span<const Rgb> colors, std::span<const double> shares);

/// Adds the mixes to Toolpath::color_changes. `filaments` are the colors of the hot end's filaments, by number. A mix
/// with a filament without a color is left out; returns how many were.
std::size_t addMixes(std::span<const MixChange> mixes, std::span<const std::optional<Rgb>> filaments,
                     Toolpath& toolpath);

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
