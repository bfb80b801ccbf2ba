// How high above earlier material a nozzle went, place by place: the height of beads that no tag and no global level
// tells: spirals, supports with layers of their own, objects printed one after another.
//
// The plan is a sparse grid of cells; each remembers the z of the last pass through it and of the one below. The rise
// of a bead is its z above the last pass underneath; a run's height is the median over its length, so that edges and
// overhangs, where something else or nothing lies below, don't count.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <span>
#include <vector>

namespace stratum::gcode {

struct LocalRise {
    double median = 0;  ///< mm; 0 if nothing lies below
    double share = 0;   ///< 0..1 of the length that has something below
};

/// By run, in print order. `wanted[k]` says whether run k's rise is asked for; all runs but those of layer 0 are
/// material for others. O(length / 1 mm) time, O(printed area) memory.
std::vector<LocalRise> localRises(const Toolpath& toolpath, const std::vector<bool>& wanted);

}  // namespace stratum::gcode
