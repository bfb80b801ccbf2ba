#include "gcode/toolpath/arc.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::gcode {
namespace {

// Points closer than this, in mm, coincide: three orders below the precision of slicers.
constexpr double kSamePoint = 1e-6;

double tolerance(double radius) { return std::max(kArcAbsoluteTolerance, kArcRelativeTolerance * radius); }

double sweepBetween(PlanPoint from, PlanPoint to, bool clockwise) {
    double sweep = std::atan2(from.x * to.y - from.y * to.x, from.x * to.x + from.y * to.y);
    if (clockwise && sweep >= 0) sweep -= 2 * std::numbers::pi;
    if (!clockwise && sweep <= 0) sweep += 2 * std::numbers::pi;
    return sweep;
}

}  // namespace

std::optional<Arc> arcFromOffset(PlanPoint start, PlanPoint end, PlanPoint offset, bool clockwise) {
    const double radius = std::hypot(offset.x, offset.y);
    if (!(radius > kSamePoint)) return std::nullopt;
    Arc arc{.center_x = start.x + offset.x, .center_y = start.y + offset.y, .sweep = 0};
    if (std::hypot(end.x - start.x, end.y - start.y) < kSamePoint) {
        arc.sweep = clockwise ? -2 * std::numbers::pi : 2 * std::numbers::pi;
        return arc;
    }
    const PlanPoint from{-offset.x, -offset.y};
    const PlanPoint to{end.x - arc.center_x, end.y - arc.center_y};
    if (std::abs(std::hypot(to.x, to.y) - radius) > tolerance(radius)) return std::nullopt;
    arc.sweep = sweepBetween(from, to, clockwise);
    return arc;
}

double klipperSweep(PlanPoint start, PlanPoint end, PlanPoint offset, bool clockwise) {
    constexpr double kTurn = 2 * std::numbers::pi;
    // The order of operations decides the sign of the tiny angle.
    const PlanPoint to{end.x - (start.x + offset.x), end.y - (start.y + offset.y)};
    double sweep = std::atan2(-offset.x * to.y + offset.y * to.x, -offset.x * to.x - offset.y * to.y);
    if (sweep < 0) sweep += kTurn;
    if (clockwise) sweep -= kTurn;
    return sweep == 0 && start.x == end.x && start.y == end.y ? kTurn : sweep;
}

std::optional<Arc> arcFromRadius(PlanPoint start, PlanPoint end, double radius, bool clockwise) {
    const PlanPoint chord{end.x - start.x, end.y - start.y};
    const double length = std::hypot(chord.x, chord.y);
    if (!(length > kSamePoint) || length / 2 - std::abs(radius) > tolerance(std::abs(radius))) return std::nullopt;
    const double squared = radius * radius - length * length / 4;
    const double height = squared > 0 ? std::sqrt(squared) : 0;  // of the center over the chord
    // Going counter-clockwise the center of the shorter arc is on the left, of the longer one on the right.
    const double side = clockwise != (radius < 0) ? -height : height;
    const Arc arc{.center_x = start.x + chord.x / 2 - side * chord.y / length,
                  .center_y = start.y + chord.y / 2 + side * chord.x / length,
                  .sweep = 0};
    return arcFromOffset(start, end, {arc.center_x - start.x, arc.center_y - start.y}, clockwise);
}

}  // namespace stratum::gcode
