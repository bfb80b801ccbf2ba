// Heights of the nozzle above earlier material at each position: for beads whose height follows neither from a tag nor
// from the levels of the print: spirals, supports with layers of their own, objects printed one after another.
//
// The plan is a sparse grid of cells; each stores the z of the last pass through it and of the one below. The rise of a
// bead is its z above the last pass underneath; a run's height is the median over its length, which ignores edges and
// overhangs.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <span>
#include <vector>

namespace stratum::gcode {

struct LocalRise {
    double median = 0;  ///< mm; 0 if nothing lies below
    double share = 0;   ///< share (0..1) of the length that has material below
};

/// By run, in print order. `wanted[k]`: whether to compute the rise of run k. All runs but those of layer 0 count as
/// material. O(length / 1 mm) time, O(printed area) memory.
std::vector<LocalRise> localRises(const Toolpath& toolpath, const std::vector<bool>& wanted);

}  // namespace stratum::gcode
