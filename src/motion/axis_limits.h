// Limits the programmed speed and acceleration of a segment to what the machine's axes allow, by the rules of the
// firmwares.
//
// Sources: Marlin 1.1 planner.cpp and PrusaSlicer's GCodeProcessor (the jerk rules); Klipper of August 2026,
// toolhead.py (Move), kinematics/cartesian.py and corexy.py (check_move), kinematics/extruder.py (check_move);
// RepRapFirmware 3.5.3, DDA.cpp (InitStandardMove). Marlin 2 counts steps: marlin_look_ahead.h.
#pragma once

#include "gcode/printer/motion.h"
#include "motion/segment.h"

namespace stratum::motion {

/// Sets speed and acceleration. For all rules but Marlin 2's.
void limitByAxes(const gcode::MachineLimits& limits, Segment& segment);

}  // namespace stratum::motion
