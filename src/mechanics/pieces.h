// Pieces of a print that no face joins: without supports of their own, each makes a linear system singular.
#pragma once

#include "mechanics/solid_elements.h"

#include <cstddef>
#include <cstdint>
#include <functional>

namespace stratum::mechanics {

struct Pieces {
    std::size_t count = 0;    ///< before
    std::size_t removed = 0;  ///< elements of the others
};

/// Keeps the piece with the most elements, of equal ones the lowest. Elements are one piece where they share a face:
/// what shares an edge alone would be a hinge.
/// @param counts  whether elements of a bead (an index into Toolpath::beads) count, e.g. those of the part; without it,
///                and if none does, all count
Pieces keepLargestPiece(SolidElements& elements, const std::function<bool(std::uint32_t)>& counts = {});

}  // namespace stratum::mechanics
