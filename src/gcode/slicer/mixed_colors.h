// The color of a mix of filaments.
#pragma once

#include "gcode/machine/mixer.h"
#include "gcode/toolpath/toolpath.h"

#include <span>
#include <vector>

namespace stratum::gcode {

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

}  // namespace stratum::gcode
