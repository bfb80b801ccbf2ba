// The speed limit at the corner between two segments of motion, by the rules of the firmwares.
//
// Sources: Marlin 1.1's classic jerk and 1.0's jerk of the plan vector (planner.cpp; PrusaSlicer's GCodeProcessor and
// CuraEngine's TimeEstimateCalculator are the same rules, with the same treatment of standstill); S. K. Jeon,
// "Improving Grbl's cornering algorithm" (2011) for junction deviation, v^2 = a d sin(t/2) / (1 - sin(t/2)), with
// Marlin 2's bounds; klipper3d.org/Kinematics.html for d = scv^2 (sqrt 2 - 1) / a, the centripetal bound and the
// extruder's.
#pragma once

#include "gcode/machine/motion.h"
#include "motion/segment.h"

namespace stratum::motion {

/// mm/s with which a segment may begin or end at standstill.
double restSpeed(const Segment& segment, const gcode::MachineLimits& limits);

/// mm/s with which `to` may begin after `from`; at most the speed of `to`. It may be more than the speed of `from`: by
/// the jerk rules a machine may change its speed by that much, even from standstill.
double cornerSpeed(const Segment& from, const Segment& to, const gcode::MachineLimits& limits);

}  // namespace stratum::motion
