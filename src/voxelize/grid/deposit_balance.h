// Fed against laid: how much of the plastic of the beads their layers have room for.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/lattice.h"
#include "voxelize/beads/layer_stack.h"
#include "voxelize/beads/plan_bins.h"
#include "voxelize/leaf/leaf_positions.h"

#include <array>
#include <cstdint>
#include <vector>

namespace stratum::voxelize {

/// mm^3.
struct DepositShare {
    double fed = 0;   ///< section area times length of the beads
    double laid = 0;  ///< their part of the solid of their layer
    /// What overlaps and has no place; negative where ends of beads, which are round, lie free.
    double surplus() const { return fed - laid; }
};

struct DepositBalance {
    DepositShare all;
    std::array<DepositShare, gcode::kFeatureCount> features;  ///< by gcode::Feature
    std::vector<DepositShare> layers;                         ///< by Run::layer
};

/// Integrates the thickness of each layer over the lattice's columns, and divides it among the beads that claim a
/// place, in proportion to their own thickness there. Overlaps of different layers are not counted, and sloped and
/// round beads count as laid whole. Of the beads before index `end`. Parallel; the result does not depend on the number
/// of threads.
DepositBalance balanceDeposit(const gcode::Toolpath& toolpath, const LayerStack& stack, const PlanBins& bins,
                              const Lattice& lattice, const ColumnSource& columns, std::uint32_t end);

/// By bead of the toolpath: the share of its plastic that has no place, 0..1; 0 for beads that are not in the stack and
/// for sloped and round ones. As balanceDeposit(), of all beads.
std::vector<float> overfillOfBeads(const gcode::Toolpath& toolpath, const LayerStack& stack, const Lattice& lattice);

}  // namespace stratum::voxelize
