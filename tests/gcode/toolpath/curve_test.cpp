#include "gcode/toolpath/arc.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::gcode {
namespace {

// The largest distance of the points from the polyline start, pieces...
double farthest(const std::vector<Point>& points, const Point& start, const std::vector<Point>& pieces) {
    double worst = 0;
    for (const Point& p : points) {
        double best = 1e9;
        Point a = start;
        for (const Point& b : pieces) {
            const double dx = b.x - a.x, dy = b.y - a.y, dz = b.z - a.z;
            const double square = dx * dx + dy * dy + dz * dz;
            const double t =
                square > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy + (p.z - a.z) * dz) / square, 0.0, 1.0)
                           : 0;
            best = std::min(best, std::hypot(p.x - a.x - t * dx, p.y - a.y - t * dy, p.z - a.z - t * dz));
            a = b;
        }
        worst = std::max(worst, best);
    }
    return worst;
}

TEST(Curve, BezierStaysWithinTheTolerance) {
    const Point start{1, 2, 0.2}, control1{4, 30, 0.2}, control2{60, -20, 0.2}, end{40, 5, 0.2};
    const auto pieces = flattenBezier(start, control1, control2, end);
    EXPECT_EQ(pieces.back().x, end.x);
    EXPECT_EQ(pieces.back().y, end.y);
    std::vector<Point> points;
    for (int i = 0; i <= 5000; ++i) {
        const double t = i / 5000.0, s = 1 - t;
        points.push_back(
            {s * s * s * start.x + 3 * s * s * t * control1.x + 3 * s * t * t * control2.x + t * t * t * end.x,
             s * s * s * start.y + 3 * s * s * t * control1.y + 3 * s * t * t * control2.y + t * t * t * end.y, 0.2});
    }
    const double error = farthest(points, start, pieces);
    EXPECT_LE(error, kCurveTolerance);
    EXPECT_GE(error, kCurveTolerance / 10);  // not finer than it must be
}

TEST(Curve, AStraightBezierIsOnePiece) {
    EXPECT_EQ(flattenBezier({0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}).size(), 1U);
    EXPECT_EQ(flattenBezier({0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}).size(), 1U);
}

TEST(Curve, UprightArcsStayWithinTheTolerance) {
    const double pi = std::numbers::pi;
    // G18: from z to x, radius 5 about x = 0, z = 10, with y going along.
    const Point start{0, 0, 15}, end{5, 1, 10};
    const auto pieces = flattenArc(start, end, {2, 0}, 10, 0, pi / 2);
    std::vector<Point> points;
    for (int i = 0; i <= 1000; ++i) {
        const double a = pi / 2 * i / 1000;
        points.push_back({5 * std::sin(a), i / 1000.0, 10 + 5 * std::cos(a)});
    }
    EXPECT_LE(farthest(points, start, pieces), kCurveTolerance);
    EXPECT_LE(pieces.size(), 20U);
}

TEST(Curve, HugeCurvesAreBounded) {
    EXPECT_LE(flattenArc({1e5, 0, 0}, {1e5, 0, 0}, {1, 2}, 0, -1e5, 600).size(), 10000U);
    EXPECT_LE(flattenBezier({-1e5, 0, 0}, {1e5, 1e5, 0}, {-1e5, -1e5, 0}, {1e5, 0, 0}).size(), 10000U);
}

}  // namespace
}  // namespace stratum::gcode
