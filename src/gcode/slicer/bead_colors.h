// The color of a bead's filament: that of the tool, as the file states it, until a manual change of filament.
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

/// sRGB of the filament of `toolpath.beads[bead]`; nullopt where the file states no color for its tool.
std::optional<Rgb> colorOf(const Toolpath& toolpath, std::size_t bead);

/// The distinct colors of the selected beads, in the order of first use; nullopt for beads without a stated color.
/// `selection` has indices into `toolpath.beads`.
std::vector<std::optional<Rgb>> distinctColors(const Toolpath& toolpath, std::span<const std::uint32_t> selection);

}  // namespace stratum::gcode
