// Pieces of a print that no face joins: without supports of their own, each makes a linear system singular.
#pragma once

#include "mechanics/solid_elements.h"

#include <cstddef>

namespace stratum::mechanics {

struct Pieces {
    std::size_t count = 0;    ///< before
    std::size_t removed = 0;  ///< elements of the others
};

/// Keeps the piece with the most elements, of equal ones the lowest. Elements are one piece where they share a face:
/// what shares an edge alone would be a hinge.
Pieces keepLargestPiece(SolidElements& elements);

}  // namespace stratum::mechanics
