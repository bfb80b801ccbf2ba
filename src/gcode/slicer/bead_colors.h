// Which colour a bead's filament has: the tool's, as the file states it, until the file changes it by hand.
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

/// sRGB of the filament of `toolpath.beads[bead]`; nullopt where the file states no colour for its tool.
std::optional<Rgb> colorOf(const Toolpath& toolpath, std::size_t bead);

/// The colours that the selected beads have, each once, in the order of first use; nullopt stands among them if beads
/// without a stated colour do. `selection` holds indices into `toolpath.beads`.
std::vector<std::optional<Rgb>> distinctColors(const Toolpath& toolpath, std::span<const std::uint32_t> selection);

}  // namespace stratum::gcode
