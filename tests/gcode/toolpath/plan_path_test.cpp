#include "gcode/toolpath/plan_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace stratum::gcode {
namespace {

PlanPath segment(double x0, double y0, double x1, double y1) {
    return {Toolpath{}, Bead{.x0 = x0, .y0 = y0, .x1 = x1, .y1 = y1, .arc = -1}};
}

// From the angle `from` about (x, y).
PlanPath arc(double x, double y, double radius, double from, double sweep) {
    Toolpath toolpath;
    toolpath.arcs.push_back({x, y, sweep});
    return {toolpath, Bead{.x0 = x + radius * std::cos(from),
                           .y0 = y + radius * std::sin(from),
                           .x1 = x + radius * std::cos(from + sweep),
                           .y1 = y + radius * std::sin(from + sweep),
                           .arc = 0}};
}

// Nearest of many points along an arc; the sampling error is below radius * step^2 / 8.
double sampledArcDistance(double cx, double cy, double radius, double from, double sweep, double x, double y) {
    double best = 1e300;
    constexpr int kSteps = 20000;
    for (int s = 0; s <= kSteps; ++s) {
        const double angle = from + sweep * s / kSteps;
        best = std::min(best, std::hypot(x - cx - radius * std::cos(angle), y - cy - radius * std::sin(angle)));
    }
    return best;
}

TEST(PlanPath, ArcDistanceAgreesWithSampledPath) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> where(-8, 8);
    for (const double sweep : {0.01, 0.7, -0.7, 3.0, -3.0, std::numbers::pi, 4.0, -5.5, 2 * std::numbers::pi}) {
        const PlanPath path = arc(1, -2, 4, 0.4, sweep);
        EXPECT_NEAR(path.length(), 4 * std::abs(sweep), 1e-12);
        double min[2];
        double max[2];
        path.bounds(min, max);
        for (int n = 0; n < 40; ++n) {
            const double x = where(random);
            const double y = where(random);
            const double expected = sampledArcDistance(1, -2, 4, 0.4, sweep, x, y);
            EXPECT_NEAR(path.distance(x, y), expected, 1e-6) << "sweep " << sweep << " at " << x << ", " << y;
            const double angle = 0.4 + sweep * path.parameter(x, y);
            EXPECT_NEAR(std::hypot(x - 1 - 4 * std::cos(angle), y + 2 - 4 * std::sin(angle)), expected, 1e-6);
        }
        for (int s = 0; s <= 100; ++s) {
            const double angle = 0.4 + sweep * s / 100;
            EXPECT_GE(1 + 4 * std::cos(angle), min[0] - 1e-9);
            EXPECT_LE(1 + 4 * std::cos(angle), max[0] + 1e-9);
            EXPECT_GE(-2 + 4 * std::sin(angle), min[1] - 1e-9);
            EXPECT_LE(-2 + 4 * std::sin(angle), max[1] + 1e-9);
        }
    }
}

TEST(PlanPath, PlacesAndDistances) {
    EXPECT_EQ(segment(1, 1, 4, 5).length(), 5);
    EXPECT_NEAR(segment(1, 1, 4, 5).at(2.5).y, 3, 1e-12);
    EXPECT_NEAR(segment(0, 0, 4, 0).distance(7, 4), 5, 1e-12);
    EXPECT_NEAR(segment(2, 2, 2, 2).distance(5, 6), 5, 1e-12);
    const PlanPath clockwise = arc(0, 0, 2, 0, -std::numbers::pi / 2);
    EXPECT_NEAR(clockwise.length(), std::numbers::pi, 1e-12);
    EXPECT_NEAR(clockwise.at(clockwise.length()).y, -2, 1e-12);
    EXPECT_NEAR(clockwise.distance(3, -3), std::hypot(3, 3) - 2, 1e-12);
    EXPECT_NEAR(clockwise.distance(0, 2), std::hypot(2, 2), 1e-12);
    EXPECT_NEAR(arc(0, 0, 2, 0, 2 * std::numbers::pi).distance(0, -0.5), 1.5, 1e-12);
    EXPECT_EQ(segment(1, 1, 5, 1).nearest(9, 3), 4);
    EXPECT_EQ(segment(1, 1, 5, 1).nearest(2, 3), 1);
    EXPECT_NEAR(clockwise.nearest(3, -3), 0.5 * clockwise.length(), 1e-12);
    EXPECT_EQ(clockwise.nearest(-1, -5), clockwise.length());
    EXPECT_EQ(clockwise.nearest(5, 1), 0);
    EXPECT_EQ(arc(0, 0, 0, 0, 1).length(), 0);
    EXPECT_TRUE(arc(0, 0, 0, 0, 1).straight());
}

// The way from one place to a place beside it.
TEST(PlanPath, DirectionsAreThoseOfItsPlaces) {
    constexpr double kStep = 1e-6;
    for (const PlanPath& path : {segment(1, 2, -3, 5), arc(1, -2, 4, 0.4, 2.5), arc(-3, 0, 0.7, 2, -5)})
        for (const double share : {0.1, 0.5, 0.9}) {
            const double mm = share * path.length();
            const PlanPoint before = path.at(mm - kStep);
            const PlanPoint after = path.at(mm + kStep);
            const PlanPoint along = path.direction(mm);
            EXPECT_NEAR(along.x, (after.x - before.x) / (2 * kStep), 1e-8);
            EXPECT_NEAR(along.y, (after.y - before.y) / (2 * kStep), 1e-8);
            EXPECT_NEAR(path.nearest(path.at(mm).x, path.at(mm).y), mm, 1e-9);
        }
    EXPECT_EQ(segment(1, 1, 1, 1).direction(0).x, 0);
    EXPECT_EQ(segment(1, 1, 1, 1).at(0).x, 1);
}

// A file rounds the ends of an arc: it lies on the circle of the mean radius.
TEST(PlanPath, ArcsWithEndsOfTwoRadiiAreOnTheMean) {
    Toolpath toolpath;
    toolpath.arcs.push_back({0, 0, std::numbers::pi / 2});
    const PlanPath path(toolpath, Bead{.x0 = 2, .y0 = 0, .x1 = 0, .y1 = 2.1, .arc = 0});
    EXPECT_NEAR(path.length(), 2.05 * std::numbers::pi / 2, 1e-12);
    for (const double share : {0.0, 0.3, 1.0}) {
        const PlanPoint place = path.at(share * path.length());
        EXPECT_NEAR(std::hypot(place.x, place.y), 2.05, 1e-12);
        EXPECT_NEAR(path.distance(place.x, place.y), 0, 1e-12);
    }
}

}  // namespace
}  // namespace stratum::gcode
