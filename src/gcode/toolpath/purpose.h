// What a bead is printed for: the part, or what slicers print beside it.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <cstdint>
#include <span>
#include <vector>

namespace stratum::gcode {

/// From what is the part to what is not.
enum class Purpose : std::uint8_t {
    part,
    support,  ///< and rafts
    brim,
    beside,  ///< skirts, prime lines, wipe towers, custom code
};

/// By bead. Tags decide where they name a feature. What comes before the first layer is a prime line. Other beads
/// without a tag are told by their place near the bed, where lines that touch are one island (but lines of less than a
/// tenth of the usual width, which are threads beside the part):
/// - an island that ends within the first three layers is a skirt if its box holds that of an island that goes on;
/// - an island of the first layer, or of the first three if it is printed before all else, is prime lines if it is
///   nowhere wider than four lines, and others go on;
/// - beads of the first layer are a brim if they run beyond the outline of the second layer on all sides, three lines
///   or more, and less than a twentieth of their length is of beads that go from below the second layer to there.
/// Towers without a tag cannot be told from parts, and count as such.
std::vector<Purpose> purposesOf(const Toolpath& toolpath);

/// Those beads of a selection (indices into Toolpath::beads) with a purpose up to `last`; all if there are none.
/// `purposes`: purposesOf().
std::vector<std::uint32_t> beadsUpTo(Purpose last, std::span<const Purpose> purposes,
                                     std::span<const std::uint32_t> selection);

}  // namespace stratum::gcode
