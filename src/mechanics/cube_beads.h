// Which bead a cube was printed as.
#pragma once

#include "mechanics/solid_elements.h"

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/lattice.h"

#include <cstdint>
#include <span>

namespace stratum::mechanics {

/// Sets SolidElement::bead of all elements: of the beads of `selection` the one whose surface is nearest to the middle.
/// `lattice`: of which layer planes, see solidElements(). Parallel.
void setBeads(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
              const voxelize::Lattice& lattice, SolidElements& elements);

}  // namespace stratum::mechanics
