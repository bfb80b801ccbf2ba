// What a tile of each layer was fed, holds, and can gain: the sums of swell_field.h.
#pragma once

#include "voxelize/swell/layer_needs.h"
#include "voxelize/swell/swell_field.h"

namespace stratum::voxelize {

/// The lattice whose leaf columns are squares of two by two cells, of LayerStack::settling_scale.
Lattice cellLattice(double settling_scale);

/// Of the tile of kSumCells there. `bins`: of cellLattice().
TileSums sumTile(const gcode::Toolpath& toolpath, const LayerStack& stack, const LayerNeeds& needs,
                 const PlanBins& bins, TilePlace place);

}  // namespace stratum::voxelize
