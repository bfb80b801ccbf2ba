// The middle of a bead's path, and the direction across it: where walls are measured.
#pragma once

#include "gcode/toolpath/plan_path.h"
#include "report/level_set/field_probe.h"

namespace stratum::report {

struct BeadMiddle {
    Point at;               ///< on the center line, at half of the bead's height
    double nx = 0, ny = 0;  ///< across the path, to its left; (0, 0) of a bead without length
};

inline BeadMiddle middleOf(const gcode::Toolpath& toolpath, const gcode::Bead& bead) {
    const gcode::PlanPath path(toolpath, bead);
    const gcode::PlanPoint place = path.at(0.5 * path.length());
    const gcode::PlanPoint along = path.direction(0.5 * path.length());
    const double height = static_cast<double>(toolpath.runOf(bead).height);
    return {{place.x, place.y, 0.5 * (bead.z0 + bead.z1) - 0.5 * height}, -along.y, along.x};
}

}  // namespace stratum::report
