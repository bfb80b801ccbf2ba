#include "mechanics/element_sets.h"

#include "toolpaths.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace stratum::mechanics {
namespace {

BeadDirection of(double dx, double dy, double dz) {
    gcode::Toolpath toolpath;
    test::addBead(toolpath, 1, 2, 3, 1 + dx, 2 + dy, 3 + dz, 0.4, 0.4);
    return directionAt(toolpath, toolpath.beads[0], 1, 2);
}

TEST(BeadDirection, ForwardAndBackAreOne) {
    for (int degree = -180; degree <= 180; ++degree) {
        const double a = degree * std::numbers::pi / 180;
        const BeadDirection forward = of(std::cos(a), std::sin(a), 0.1);
        EXPECT_EQ(forward, of(-std::cos(a), -std::sin(a), -0.1)) << degree;
        EXPECT_EQ(forward.azimuth, (degree + 360) % 180);
        EXPECT_EQ(std::abs(forward.elevation), 6);  // atan(0.1)
    }
    EXPECT_EQ(of(0, 0, 1), (BeadDirection{0, 90}));
    EXPECT_EQ(of(0, 0, -1), (BeadDirection{0, 90}));
    EXPECT_EQ(of(0, 0, 0), (BeadDirection{0, 0}));
    EXPECT_EQ(of(1, -0.001, 0), (BeadDirection{0, 0}));
    EXPECT_EQ(of(-1, -0.001, 0), (BeadDirection{0, 0}));
}

TEST(BeadDirection, TurnsWithAnArc) {
    for (const double sweep : {std::numbers::pi, -std::numbers::pi}) {
        gcode::Toolpath toolpath;
        test::addArc(toolpath, 0, 0, 5, 0, sweep, 0.2, 0.2, 0.4, 0.2);
        for (int degree = 1; degree < 180; ++degree) {
            const double a = degree * std::numbers::pi / 180 * (sweep > 0 ? 1 : -1);
            EXPECT_EQ(directionAt(toolpath, toolpath.beads[0], 5 * std::cos(a), 5 * std::sin(a)).azimuth,
                      ((sweep > 0 ? degree : -degree) + 90 + 360) % 180)
                << degree << ' ' << sweep;
        }
    }
}

}  // namespace
}  // namespace stratum::mechanics
