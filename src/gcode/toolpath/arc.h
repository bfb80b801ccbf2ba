// Center and sweep of a G2/G3 move in the plane, from I/J or from R.
// Sources: NIST RS274/NGC 3.5.3; Marlin G2_G3.cpp (which of the two centers R means).
#pragma once

#include "gcode/toolpath/plan_path.h"
#include "gcode/toolpath/toolpath.h"

#include <optional>

namespace stratum::gcode {

/// Largest distance of the end from the circle: this share of the radius, or this many mm if that is more. Slicers
/// write three decimals; an arc with a larger error is damaged or not an arc.
constexpr double kArcRelativeTolerance = 0.05;
constexpr double kArcAbsoluteTolerance = 0.1;

/// The arc from `start` to `end` about start + `offset`. Start and end in one point make a full circle.
/// nullopt if the radius is zero or the end is off the circle.
std::optional<Arc> arcFromOffset(PlanPoint start, PlanPoint end, PlanPoint offset, bool clockwise);

/// The sweep, radians, of the arc from `start` to `end` about start + `offset` by Klipper's own arithmetic. An end that
/// is the start makes a full circle, or nothing where the rounding of the numbers leaves a tiny angle: about half of a
/// slicer's spiral lifts are straight lines there. (Klipper of August 2026, klippy/extras/gcode_arcs.py)
double klipperSweep(PlanPoint start, PlanPoint end, PlanPoint offset, bool clockwise);

/// The arc of `radius` (mm) from `start` to `end`: the shorter one if it is positive, the longer one if negative.
/// nullopt if the points coincide or lie further apart than the diameter.
std::optional<Arc> arcFromRadius(PlanPoint start, PlanPoint end, double radius, bool clockwise);

}  // namespace stratum::gcode
