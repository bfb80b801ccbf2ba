// The middle of a bead's path, and the direction across it: where walls are measured.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "report/level_set/field_probe.h"

#include <cmath>

namespace stratum::report {

struct BeadMiddle {
    Point at;               ///< on the center line, at half of the bead's height
    double nx = 0, ny = 0;  ///< across the path, to its left; (0, 0) of a bead without length
};

inline BeadMiddle middleOf(const gcode::Toolpath& toolpath, const gcode::Bead& bead) {
    BeadMiddle middle;
    const double height = static_cast<double>(toolpath.runOf(bead).height);
    middle.at.z = 0.5 * (bead.z0 + bead.z1) - 0.5 * height;
    if (bead.arc < 0) {
        middle.at.x = 0.5 * (bead.x0 + bead.x1);
        middle.at.y = 0.5 * (bead.y0 + bead.y1);
        const double dx = bead.x1 - bead.x0;
        const double dy = bead.y1 - bead.y0;
        const double length = std::hypot(dx, dy);
        if (length > 0) middle.nx = -dy / length, middle.ny = dx / length;
        return middle;
    }
    const gcode::Arc& arc = toolpath.arcs[static_cast<std::size_t>(bead.arc)];
    const double dx = bead.x0 - arc.center_x;
    const double dy = bead.y0 - arc.center_y;
    const double cosine = std::cos(0.5 * arc.sweep);
    const double sine = std::sin(0.5 * arc.sweep);
    const double x = cosine * dx - sine * dy;
    const double y = sine * dx + cosine * dy;
    middle.at.x = arc.center_x + x;
    middle.at.y = arc.center_y + y;
    const double radius = std::hypot(x, y);
    if (radius > 0) middle.nx = x / radius, middle.ny = y / radius;
    return middle;
}

}  // namespace stratum::report
