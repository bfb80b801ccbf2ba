#include "voxelize/beads/bead_field.h"

#include "toolpaths.h"

#include <gtest/gtest.h>

#include <random>

namespace stratum::voxelize {
namespace {

using test::addArc;
using test::addBead;

TEST(BeadField, StadiumHasItsWidthAndHeight) {
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 0.3, 10, 0, 0.3, 0.5, 0.2);
    const BeadField field(toolpath, toolpath.beads[0]);
    EXPECT_NEAR(field.distance(5, 0.25, 0.2), 0, 1e-7);   // side
    EXPECT_NEAR(field.distance(5, 0, 0.3), 0, 1e-7);      // nozzle
    EXPECT_NEAR(field.distance(5, 0, 0.1), 0, 1e-7);      // underside
    EXPECT_NEAR(field.distance(10.25, 0, 0.2), 0, 1e-7);  // round end
    EXPECT_NEAR(field.distance(5, 0, 0.2), -0.1, 1e-7);   // core
    EXPECT_NEAR(field.distance(5, 1.25, 0.2), 1, 1e-7);
    const Bounds box = field.bounds();
    EXPECT_NEAR(box.min[0], -0.25, 1e-7);
    EXPECT_NEAR(box.max[0], 10.25, 1e-7);
    EXPECT_NEAR(box.min[2], 0.1, 1e-7);
    EXPECT_NEAR(box.max[2], 0.3, 1e-7);
}

TEST(BeadField, SectionAreaIsWhatTheFieldEncloses) {
    for (const double width : {0.15, 0.2, 0.45, 2.0}) {
        gcode::Toolpath toolpath;
        addBead(toolpath, 0, -10, 0.2, 0, 10, 0.2, width, 0.2);
        const BeadField field(toolpath, toolpath.beads[0]);
        constexpr double kStep = 0.0005;
        double area = 0;
        for (double x = -width; x < width; x += kStep)
            for (double z = -0.1; z < 0.4; z += kStep)
                area += field.distance(x + kStep / 2, 0, z + kStep / 2) < 0 ? kStep * kStep : 0;
        EXPECT_NEAR(area, gcode::sectionArea(width, 0.2), 2e-3 * area) << width;
    }
}

TEST(BeadField, SlopedBeadFollowsItsSurface) {
    // On the long sides the field of a slope is exact: the vertical offset times the cosine is the perpendicular one.
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 1, 20, 0, 3, 0.6, 0.2);
    const BeadField field(toolpath, toolpath.beads[0]);
    const double cosine = 20 / std::hypot(20, 2);
    for (double x = 5; x < 15; x += 0.7) {
        const double center = 1 + x * 0.1 - 0.1;
        EXPECT_NEAR(field.distance(x, 0, center + 0.5 / cosine), 0.4, 1e-6);
        // The underside reaches 0.02 of the height lower, to weld it to the turn below.
        EXPECT_NEAR(field.distance(x, 0, center - 0.5 / cosine), 0.4 - kSlopedReach * 0.2, 1e-6);
    }
}

TEST(BeadField, SteepAndRoundSlopesAreRods) {
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 1, 1, 0, 9, 0.6, 0.2);   // steep: the section area of the stadium, but round
    addBead(toolpath, 0, 0, 1, 8, 0, 5, 0.15, 0.2);  // round from the start
    const BeadField steep(toolpath, toolpath.beads[0]);
    EXPECT_NEAR(std::numbers::pi * steep.radius() * steep.radius(), gcode::sectionArea(0.6, 0.2), 1e-6);
    EXPECT_NEAR(steep.distance(0.5, 3, 4.9), std::hypot(3.0, 0.0) - steep.radius(), 1e-3);
    const BeadField round(toolpath, toolpath.beads[1]);
    EXPECT_NEAR(round.radius(), 0.075, 1e-7);
    EXPECT_NEAR(round.distance(4, 0, 2.9 + 0.5), 0.5 * 8 / std::hypot(8, 4) - 0.075, 1e-6);
}

// Along vertical lines through beads of all kinds the field is negative between both heights alone.
TEST(BeadField, HeightsAreWhereTheFieldIsNegative) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> where(-2, 2);
    std::uniform_real_distribution<double> size(0.1, 1.2);
    int met = 0;
    for (int n = 0; n < 400; ++n) {
        gcode::Toolpath toolpath;
        if (n % 4 == 0) toolpath.deposit.corner_fraction = 0.5;
        const double x = where(random);
        const double y = where(random);
        const double z = where(random);
        switch (n % 5) {
            case 0:
                addBead(toolpath, x, y, z, where(random), where(random), z, size(random), size(random));
                break;
            case 1:
                addBead(toolpath, x, y, z, x, y, z + 1.5, size(random), size(random));
                break;  // upright
            case 2:
                addArc(toolpath, x, y, 1.5, where(random), 2 * where(random), z, z + where(random), size(random),
                       size(random));
                break;
            case 3:
                addBead(toolpath, x, y, z, x, y, z, size(random), size(random));
                break;  // a point
            default:
                addBead(toolpath, x, y, z, where(random), where(random), where(random), size(random), size(random));
        }
        const BeadField field(toolpath, toolpath.beads[0]);
        const Bounds box = field.bounds();
        for (int k = 0; k < 60; ++k) {
            const double px = 1.5 * where(random);
            const double py = 1.5 * where(random);
            const std::optional<Extent> extent = field.heights(px, py);
            constexpr double kEdge = 1e-9;
            if (extent) {
                ++met;
                EXPECT_LE(field.distance(px, py, extent->z_min), kEdge);
                EXPECT_LE(field.distance(px, py, 0.5 * (extent->z_min + extent->z_max)), kEdge);
                EXPECT_LE(field.distance(px, py, extent->z_max), kEdge);
            }
            for (double at = box.min[2] - 0.1; at < box.max[2] + 0.1; at += 0.013) {
                const bool inside = extent && at > extent->z_min + 1e-6 && at < extent->z_max - 1e-6;
                const bool outside = !extent || at < extent->z_min - 1e-6 || at > extent->z_max + 1e-6;
                const double value = field.distance(px, py, at);
                if (inside) EXPECT_LT(value, 0) << n << " at " << at;
                if (outside) EXPECT_GT(value, 0) << n << " at " << at;
            }
        }
    }
    EXPECT_GT(met, 800);
}

TEST(BeadField, BoundsHoldTheSolid) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> where(-3, 3);
    std::uniform_real_distribution<double> size(0.1, 1.5);
    for (int n = 0; n < 60; ++n) {
        gcode::Toolpath toolpath;
        if (n % 2 == 0)
            addBead(toolpath, where(random), where(random), where(random), where(random), where(random), where(random),
                    size(random), size(random));
        else
            addArc(toolpath, where(random), where(random), size(random), where(random), where(random), where(random),
                   where(random), size(random), size(random));
        const BeadField field(toolpath, toolpath.beads[0]);
        const Bounds box = field.bounds();
        for (int p = 0; p < 300; ++p) {
            const double x[3] = {where(random) * 2, where(random) * 2, where(random) * 2};
            if (field.distance(x[0], x[1], x[2]) > 0) continue;
            for (int axis = 0; axis < 3; ++axis) {
                EXPECT_GE(x[axis], box.min[axis] - 1e-9);
                EXPECT_LE(x[axis], box.max[axis] + 1e-9);
            }
        }
    }
}

}  // namespace
}  // namespace stratum::voxelize
