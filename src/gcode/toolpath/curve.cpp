#include "gcode/toolpath/curve.h"

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

}  // namespace stratum::gcode
