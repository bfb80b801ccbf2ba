// Fed against laid: how much of the plastic of the beads their layers have room for.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/layer_stack.h"

#include <array>
#include <cstdint>
#include <vector>

namespace stratum::voxelize {

/// mm^3.
struct DepositShare {
    double fed = 0;  ///< section area times length of the beads
    /// Their part of what their layer holds with its grooves filled; of sloped and round ones the solid of each.
    double laid = 0;
    /// What overlaps and has no place there; negative where ends of beads, which are round, lie free.
    double surplus() const { return fed - laid; }
};

struct DepositBalance {
    DepositShare all;
    double pressed_out = 0;  ///< mm^3 by which layers hold more where surplus moves their outlines out: swell_field.h
    double raised = 0;       ///< mm^3 by which it raises open tops, less what crowns take from their lines' edges
    double shared = 0;       ///< mm^3 that are held twice: by two layers, e.g. under threads of bridges that lie on a
                             ///< layer, or by a sloped or round bead and by what it meets
    std::array<DepositShare, gcode::kFeatureCount> features;  ///< by gcode::Feature
    std::vector<DepositShare> layers;                         ///< by Run::layer
    /// mm^3 of the solid, and what has no place in it.
    double held() const { return all.laid + pressed_out + raised - shared; }
    double unplaced() const { return all.fed - held(); }
};

/// Integrates the thickness of each layer, and divides it among the beads that claim a place, in proportion to their
/// own thickness there.
/// Of the beads before index `end`. From the plan fields themselves, at points of a lattice rule: 400 a mm^2, of
/// layers of more than 0.4 mm as many as fit 8 times in the thinnest one's height. The same for every voxel size.
/// Parallel; the result does not depend on the number of threads.
DepositBalance balanceDeposit(const gcode::Toolpath& toolpath, const LayerStack& stack, std::uint32_t end);

/// The volume of the union of all beads, mm^3: each point of the plan has an interval of heights in each layer and in
/// each sloped or round bead, and intervals that overlap count once. From the same points as balanceDeposit(), so it
/// does not depend on a voxel size either. Parallel; the same for any number of threads.
double solidVolume(const gcode::Toolpath& toolpath, const LayerStack& stack, std::uint32_t end);

/// By bead of the toolpath: the share of its plastic that has no place in its layer's grooves, 0..1; 0 for beads that
/// are not in the stack and for sloped and round ones. As balanceDeposit(), of all beads.
std::vector<float> overfillOfBeads(const gcode::Toolpath& toolpath, const LayerStack& stack);

}  // namespace stratum::voxelize
