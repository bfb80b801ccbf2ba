// What a tile of each layer was fed, holds, and can gain: the sums of swell_field.h.
#pragma once

#include "voxelize/swell/swell_field.h"

namespace stratum::voxelize {

/// The lattice whose leaf columns are squares of two by two cells.
Lattice cellLattice();

/// Of the tile from node (kTileCells x, kTileCells y). `bins`: of cellLattice().
TileSums sumTile(const gcode::Toolpath& toolpath, const LayerStack& stack, const PlanBins& bins, int x, int y);

}  // namespace stratum::voxelize
