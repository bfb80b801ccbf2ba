// The speed limit at the corner between two segments of motion, by the rules of jerk.
//
// Sources: Marlin 1.1's classic jerk and 1.0's jerk of the plan vector (planner.cpp; PrusaSlicer's GCodeProcessor and
// CuraEngine's TimeEstimateCalculator are the same rules, with the same treatment of standstill); BambuStudio's
// GCodeProcessor (process_VG1, process_G2_G3), which OrcaSlicer shares; RepRapFirmware 3.5.3, DDA.cpp
// (InitStandardMove, MatchSpeeds). Klipper's and Marlin 2's corners belong to their queues: klipper_look_ahead.h,
// marlin_look_ahead.h.
#pragma once

#include "gcode/printer/motion.h"
#include "motion/segment.h"

namespace stratum::motion {

/// mm/s by which the speed of an axis jumps. An axis that reverses stops and starts: the larger of both counts, not
/// their sum.
double axisJump(double before, double after);

/// mm/s with which a segment may begin or end at standstill.
double restSpeed(const Segment& segment, const gcode::MachineLimits& limits);

/// By CornerRule::bambu_jerk, mm/s at which the centripetal acceleration of a curve is that of printing: of a whole
/// arc, or of straight pieces whose directions differ by less than 29 degrees; else infinite.
double curveSpeed(const Segment* from, const Segment& to, const gcode::MachineLimits& limits);

/// mm/s with which `to` may begin after `from`; at most the speed of `to`. It may be more than the speed of `from`: by
/// the jerk rules a machine may change its speed by that much, even from standstill.
double cornerSpeed(const Segment& from, const Segment& to, const gcode::MachineLimits& limits);

}  // namespace stratum::motion
