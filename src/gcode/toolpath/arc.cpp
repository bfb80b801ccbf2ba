#include "gcode/toolpath/arc.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::gcode {
namespace {

constexpr double kMostPieces = 10000;  // far more than a curve as wide as a printer needs

std::size_t pieces(double wanted) { return static_cast<std::size_t>(std::clamp(std::ceil(wanted), 1.0, kMostPieces)); }

}  // namespace

std::vector<Point> flattenBezier(const Point& start, const Point& control1, const Point& control2, const Point& end) {
    const double bend =
        std::max(std::hypot(start.x - 2 * control1.x + control2.x, start.y - 2 * control1.y + control2.y),
                 std::hypot(control1.x - 2 * control2.x + end.x, control1.y - 2 * control2.y + end.y));
    const std::size_t count = pieces(std::sqrt(0.75 * bend / kCurveTolerance));
    std::vector<Point> points;
    points.reserve(count);
    for (std::size_t i = 1; i < count; ++i) {
        const double t = static_cast<double>(i) / static_cast<double>(count);
        const double s = 1 - t;
        const double b0 = s * s * s, b1 = 3 * s * s * t, b2 = 3 * s * t * t, b3 = t * t * t;
        points.push_back({b0 * start.x + b1 * control1.x + b2 * control2.x + b3 * end.x,
                          b0 * start.y + b1 * control1.y + b2 * control2.y + b3 * end.y,
                          start.z + t * (end.z - start.z)});
    }
    points.push_back(end);
    return points;
}

std::vector<Point> flattenArc(const Point& start, const Point& end, Plane plane, double center_first,
                              double center_second, double sweep) {
    const double radius = std::hypot(start[plane.first] - center_first, start[plane.second] - center_second);
    const double radius_end = std::hypot(end[plane.first] - center_first, end[plane.second] - center_second);
    const double angle = std::atan2(start[plane.second] - center_second, start[plane.first] - center_first);
    // Sagitta of a chord over the angle a: r (1 - cos(a / 2)).
    const double sagitta = std::min(kCurveTolerance / std::max(radius, kCurveTolerance), 1.0);
    const std::size_t count = pieces(std::abs(sweep) / (2 * std::acos(1 - sagitta)));
    const std::size_t normal = plane.normal();
    std::vector<Point> points;
    points.reserve(count);
    for (std::size_t i = 1; i < count; ++i) {
        const double t = static_cast<double>(i) / static_cast<double>(count);
        const double r = radius + t * (radius_end - radius);
        Point point;
        point[plane.first] = center_first + r * std::cos(angle + t * sweep);
        point[plane.second] = center_second + r * std::sin(angle + t * sweep);
        point[normal] = start[normal] + t * (end[normal] - start[normal]);
        points.push_back(point);
    }
    points.push_back(end);
    return points;
}

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
