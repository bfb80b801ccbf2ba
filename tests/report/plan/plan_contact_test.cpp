#include "report/plan/plan_contact.h"

#include "reported_print.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace stratum::report {
namespace {

using test::addBead;
using test::allBeads;
using test::layeredLattice;

PlanContact contactOf(const gcode::Toolpath& toolpath, double height, int voxels) {
    const auto beads = allBeads(toolpath);
    return measureContact(toolpath, beads, layeredLattice(height, voxels));
}

// Lines along x, above lines along y: a layer rests on the other where they cross.
gcode::Toolpath crossed(double spacing, double width, double height, double turned) {
    gcode::Toolpath toolpath;
    constexpr int kLines = 12;
    const double edge = kLines * spacing;
    const double cosine = std::cos(turned);
    const double sine = std::sin(turned);
    const auto add = [&](double x0, double y0, double x1, double y1, int layer) {
        addBead(toolpath, cosine * x0 - sine * y0, sine * x0 + cosine * y0, layer * height, cosine * x1 - sine * y1,
                sine * x1 + cosine * y1, layer * height, width, height, static_cast<std::uint32_t>(layer));
    };
    for (int n = 0; n < kLines; ++n) {
        const double at = (n + 0.5) * spacing;
        add(at, -width, at, edge + width, 1);
        // Ends are in the middle between lines below, so the share is that of whole periods.
        add(width / 2, at, edge - width / 2, at, 2);
    }
    return toolpath;
}

TEST(PlanContact, BondingOfCrossedLines) {
    constexpr double kWidth = 0.6;
    constexpr double kHeight = 0.2;
    for (const double turned : {0.0, 0.4})
        for (const double spacing : {1.0, 1.37, 2.0}) {
            const PlanContact contact = contactOf(crossed(spacing, kWidth, kHeight, turned), kHeight, 4);
            ASSERT_EQ(contact.layers.size(), 3U);
            const LayerContact& upper = contact.layers[2];
            // A line is a bar with half discs at its ends. It lies over twelve lines.
            const double length = 12 * spacing - kWidth;
            const double area = 12 * (length * kWidth + std::numbers::pi * kWidth * kWidth / 4);
            const double supported = 144 * kWidth * kWidth;
            EXPECT_NEAR(upper.area, area, 0.003 * area);
            EXPECT_NEAR(upper.supported / upper.area, supported / area, 0.01 * supported / area) << spacing;
            const double flat = kWidth - kHeight;
            EXPECT_NEAR(upper.contact, 144 * flat * flat, 0.02 * 144 * flat * flat);
            EXPECT_FALSE(upper.on_bed);
            EXPECT_TRUE(contact.layers[1].on_bed);
        }
}

TEST(PlanContact, WithTheBed) {
    gcode::Toolpath toolpath;
    addBead(toolpath, 0.03, 0.01, 0.3, 30, 7, 0.3, 0.8, 0.3, 1);
    const double length = std::hypot(29.97, 6.99);
    const PlanContact contact = contactOf(toolpath, 0.3, 3);
    EXPECT_NEAR(contact.bed_outline, length * 0.8 + std::numbers::pi * 0.16, 0.005 * contact.bed_outline);
    EXPECT_NEAR(contact.bed_contact, length * 0.5 + std::numbers::pi * 0.0625, 0.005 * contact.bed_contact);
    EXPECT_NEAR(contact.layers[1].supported, contact.bed_outline, 1e-6);
}

// Each line lies `step` beside the one below, so that much of its width has nothing below.
TEST(PlanContact, ALeaningWall) {
    constexpr double kHeight = 0.2;
    constexpr double kLength = 40;
    for (const double step : {0.05, 0.15, 0.3}) {
        gcode::Toolpath toolpath;
        for (int n = 0; n < 10; ++n)
            addBead(toolpath, 0, step * n, kHeight * (n + 1), kLength, step * n, kHeight * (n + 1), 0.6, kHeight,
                    static_cast<std::uint32_t>(n + 1));
        const PlanContact contact = contactOf(toolpath, kHeight, 4);
        for (std::size_t n = 2; n <= 10; ++n) {
            const LayerContact& layer = contact.layers[n];
            // Lunes at both ends: of discs of radius 0.3 at a distance of `step`.
            const double d = step;
            const double r = 0.3;
            const double lens = 2 * r * r * std::acos(d / (2 * r)) - d / 2 * std::sqrt(4 * r * r - d * d);
            const double free = kLength * step + std::numbers::pi * r * r - lens;
            EXPECT_NEAR(layer.area - layer.supported, free, 0.01 * free) << step;
            // Beyond a cone: what of the strip is wider than height times its tangent.
            for (std::size_t a = 0; a < kConeAngles.size(); ++a) {
                const double wide = step - kHeight * std::tan(kConeAngles[a] * std::numbers::pi / 180);
                EXPECT_NEAR(layer.beyond_cone[a], kLength * std::max(wide, 0.0), kLength * 0.03) << step << " " << a;
            }
        }
    }
}

// The same anywhere on the lattice, and along whatever direction.
TEST(PlanContact, ALeaningWallAnywhere) {
    constexpr double kHeight = 0.2;
    constexpr double kLength = 40;
    constexpr double kStep = 0.45;
    double worst_free = 0;
    double worst_cone = 0;
    for (const double turned : {0.0, 0.3, 0.7853981633974483})
        for (const double offset : {0.0, 0.011, 0.023, 0.037}) {
            gcode::Toolpath toolpath;
            const double x = std::cos(turned);
            const double y = std::sin(turned);
            for (int n = 0; n < 10; ++n) {
                const double across = kStep * n + offset;
                addBead(toolpath, -y * across, x * across, kHeight * (n + 1), kLength * x - y * across,
                        kLength * y + x * across, kHeight * (n + 1), 0.6, kHeight, static_cast<std::uint32_t>(n + 1));
            }
            const PlanContact contact = contactOf(toolpath, kHeight, 4);
            const double r = 0.3;
            const double lens =
                2 * r * r * std::acos(kStep / (2 * r)) - kStep / 2 * std::sqrt(4 * r * r - kStep * kStep);
            const double free = kLength * kStep + std::numbers::pi * r * r - lens;
            const double wide = kStep - kHeight * std::tan(kConeAngles[1] * std::numbers::pi / 180);
            for (std::size_t n = 2; n <= 10; ++n) {
                const LayerContact& layer = contact.layers[n];
                worst_free = std::max(worst_free, std::abs((layer.area - layer.supported) / free - 1));
                worst_cone = std::max(worst_cone, std::abs(layer.beyond_cone[1] / (kLength * wide) - 1));
            }
        }
    RecordProperty("free", std::to_string(worst_free));
    RecordProperty("cone", std::to_string(worst_cone));
    EXPECT_LT(worst_free, 0.02);
    EXPECT_LT(worst_cone * (kStep - kHeight * std::sqrt(3.0)), 0.03);
}

// A bridge between two towers: nothing below it, out to the middle.
TEST(PlanContact, ABridge) {
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 0.2, 0, 4, 0.2, 0.5, 0.2, 1);
    addBead(toolpath, 10, 0, 0.2, 10, 4, 0.2, 0.5, 0.2, 1);
    addBead(toolpath, 0, 2, 0.4, 10, 2, 0.4, 0.5, 0.2, 2);
    const PlanContact contact = contactOf(toolpath, 0.2, 4);
    const LayerContact& bridge = contact.layers[2];
    EXPECT_NEAR(bridge.area - bridge.supported, 9.5 * 0.5, 0.02 * 9.5 * 0.5);
    const double far = 0.2 * std::tan(75 * std::numbers::pi / 180);
    EXPECT_NEAR(bridge.beyond_cone[2], (9.5 - 2 * far) * 0.5, 0.05);
}

TEST(PlanContact, FloatingLayersRestOnNothing) {
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 0.2, 10, 0, 0.2, 0.5, 0.2, 1);
    addBead(toolpath, 0, 0, 0.6, 10, 0, 0.6, 0.5, 0.2, 2);
    const PlanContact contact = contactOf(toolpath, 0.2, 4);
    EXPECT_EQ(contact.layers[2].supported, 0);
    EXPECT_NEAR(contact.layers[2].beyond_cone[2], contact.layers[2].area, 0.02 * contact.layers[2].area);
}

// Layers of 0.2 mm, and one of 0.8: its cones reach beyond what a cone of the usual layer needs.
TEST(PlanContact, ConesOfAHighLayer) {
    const double far = 0.8 * std::tan(75 * std::numbers::pi / 180);
    for (const double beyond : {-0.4, 0.5}) {
        gcode::Toolpath toolpath;
        for (std::uint32_t layer = 1; layer <= 8; ++layer)
            addBead(toolpath, 0, 0, 0.2 * layer, 0, 20, 0.2 * layer, 1, 0.2, layer);
        const double out = far + beyond;
        addBead(toolpath, 0, 0, 2.4, 0, 20, 2.4, 1 + 2 * out, 0.8, 9);
        const PlanContact contact = contactOf(toolpath, 0.2, 4);
        const LayerContact& high = contact.layers[9];
        EXPECT_GT(high.area - high.supported, 2 * 20 * out);
        // Both sides, and rings at the ends, to a pixel of their width.
        const double around = 40 + std::numbers::pi * (2 * (0.5 + far) + beyond);
        EXPECT_NEAR(high.beyond_cone[2], std::max(beyond, 0.0) * around, beyond < 0 ? 0.01 : 0.05 * around) << beyond;
    }
}

// Two objects, one after the other: each has its layers, and the second rests on its own.
TEST(PlanContact, ObjectsPrintedOneAfterAnother) {
    gcode::Toolpath toolpath;
    for (std::uint32_t object = 0; object < 2; ++object)
        for (std::uint32_t layer = 1; layer <= 3; ++layer) {
            const double z = 0.2 * layer;
            const double length = object == 0 || layer < 3 ? 5 : 10;
            addBead(toolpath, 20.0 * object, 0, z, 20.0 * object + length, 0, z, 0.5, 0.2, 3 * object + layer);
        }
    const PlanContact contact = contactOf(toolpath, 0.2, 4);
    ASSERT_EQ(contact.layers.size(), 7U);
    for (std::size_t n = 1; n <= 6; ++n) {
        EXPECT_GT(contact.layers[n].area, 2.4) << n;
        EXPECT_EQ(contact.layers[n].on_bed, n == 1 || n == 4) << n;
    }
    EXPECT_NEAR(contact.layers[3].supported, contact.layers[3].area, 1e-3);
    EXPECT_NEAR(contact.layers[6].supported / contact.layers[6].area, 0.52, 0.03);
}

}  // namespace
}  // namespace stratum::report
