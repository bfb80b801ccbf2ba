// Between which heights each layer lies, for what is measured of the level set by layer.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "report/level_set/solid_sums.h"
#include "voxelize/beads/lattice.h"
#include "voxelize/beads/layer_stack.h"

#include <vector>

namespace stratum::report {

struct Slab {
    double bottom = 0, top = 0;                ///< mm
    double plastic = 0, open = 0, closed = 0;  ///< mm^3
};

struct Slabs {
    std::vector<Slab> slabs;  ///< ascending, each from the top of the one before
    bool layers = false;      ///< one a layer, by number; else of one layer height each
};

/// One slab a layer where the layers' tops ascend with their numbers. Where they do not (objects one after the other,
/// sloped beads alone), slabs of the layer height. Rows of cells that two slabs share are divided by height.
Slabs divideByLayer(const gcode::Toolpath& toolpath, const voxelize::LayerStack& stack,
                    const voxelize::Lattice& lattice, const SolidSums& sums);

}  // namespace stratum::report
