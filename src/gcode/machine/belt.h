// Belt printers: the gantry leans over a belt, and Z moves the belt.
//
// A program's x and y are in the gantry's plane, which makes `angle` with the belt; Z counts along the belt. As seen
// from the print, the nozzle goes back along the belt as Z grows: by cos(angle) Z within the gantry's plane and by
// sin(angle) Z away from it. Print space here is the gantry's: z is the distance from the first layer, across the
// layers. Turned by `angle` about x, which Toolpath::belt_angle hands on, the print lies as it does in the world: a
// nozzle at (x, y, Z) is at (x, y cos(angle) - Z, y sin(angle)) there, so the belt is at height 0.
// Sources: geometry; Creality's CR-30 and Blackbelt's Cura, whose Z grows by layer height / sin(angle) a layer.
#pragma once

#include "gcode/toolpath/frame.h"
#include "gcode/toolpath/toolpath.h"

#include <cmath>
#include <numbers>

namespace stratum::gcode {

/// degrees between gantry and belt
constexpr double kFlattestBelt = 5;
constexpr double kSteepestBelt = 85;

class Belt {
public:
    /// `angle`: degrees
    explicit Belt(double angle)
        : along_(std::cos(angle * std::numbers::pi / 180)), across_(std::sin(angle * std::numbers::pi / 180)) {}

    /// Print space of a nozzle's position, mm.
    Point place(const Point& nozzle) const { return {nozzle.x, nozzle.y - along_ * nozzle.z, across_ * nozzle.z}; }
    /// The same of an arc at a level of z.
    Arc place(Arc arc, double z) const {
        arc.center_y -= along_ * z;
        return arc;
    }

private:
    double along_, across_;  // of a mm of Z
};

}  // namespace stratum::gcode
