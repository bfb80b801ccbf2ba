// Solid cubes -> numbered nodes and hexahedra.
#pragma once

#include "mechanics/solid_elements.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace stratum::mechanics {

/// A corner of cubes, in edges from the origin of the elements.
struct Node {
    std::int32_t i = 0, j = 0, k = 0;
};

/// Nodes are numbered from 0, plane by plane from the lowest, so that those of a layer follow each other.
struct Hexahedra {
    std::vector<Node> nodes;  ///< ascending k, then j, then i; every one belongs to an element
    /// By element: four nodes of its lower face, counter-clockwise from above, from the corner of least x and y; then
    /// those above them. So C3D8 wants it.
    std::vector<std::array<std::uint32_t, 8>> corners;
};

/// Throws UsageError if there are more than `most_nodes`. Parallel; the result does not depend on the number of
/// threads.
Hexahedra hexahedraOf(const SolidElements& elements, std::size_t most_nodes);

}  // namespace stratum::mechanics
