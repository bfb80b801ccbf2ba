// Center and sweep of a G2/G3 move in the plane, from I/J or from R.
// Sources: NIST RS274/NGC 3.5.3; Marlin G2_G3.cpp (which of the two centers R means).
#pragma once

#include "gcode/toolpath/frame.h"
#include "gcode/toolpath/plan_path.h"
#include "gcode/toolpath/toolpath.h"

#include <optional>
#include <vector>

namespace stratum::gcode {

// Flattens curves that Bead can't represent: cubic Béziers (G5) and arcs in vertical planes (G18, G19).
//
// The ends of the pieces are on the curve, and no point of the curve is further than kCurveTolerance from its piece.
// Sources: marlinfw.org/docs/gcode G005 and G017-G019; NIST RS274/NGC 3.5.2 and 3.5.3; for the number of pieces,
// Wang's bound on the second differences of a Bézier's control points and the sagitta of a chord.

/// mm. A slicer's own tolerance is 0.0125 (PrusaSlicer's gcode_resolution), its last digit 0.001.
constexpr double kCurveTolerance = 0.005;

/// The ends of the pieces of a plan Bézier, the last of them `end`; z runs linearly in the curve's parameter, as in
/// Marlin. Never empty.
std::vector<Point> flattenBezier(const Point& start, const Point& control1, const Point& control2, const Point& end);

/// The two axes of an arc's plane in turning order: G17 x to y, G18 z to x, G19 y to z.
struct Plane {
    std::size_t first = 0;
    std::size_t second = 1;
    std::size_t normal() const { return 3 - first - second; }
};

/// The ends of the pieces of a path that turns by `sweep` (radians, positive from `first` to `second`) about the point
/// (first, second) = (`center_first`, `center_second`) and goes along the normal evenly. Never empty.
std::vector<Point> flattenArc(const Point& start, const Point& end, Plane plane, double center_first,
                              double center_second, double sweep);

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
