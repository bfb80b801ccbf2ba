#include "deposit/sag.h"

#include "base/input_file.h"
#include "corpus.h"
#include "deposit/bead_support.h"
#include "gcode/reader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>

namespace stratum::deposit {
namespace {

constexpr double kZ = 0.4;  // mm, of the layer that hangs
// A wall of 0.4 mm carries a bead of 0.4 mm to here beyond its own path.
const double kHold = 0.75 * double{0.4F};

// Walls along y at x = 0 and x = 10, on the bed.
gcode::Toolpath twoWalls() {
    gcode::Toolpath toolpath;
    toolpath.runs = {{.height = 0.2F, .layer = 1}, {.height = 0.2F, .layer = 2, .feature = gcode::Feature::bridge}};
    for (const double x : {0.0, 10.0})
        toolpath.beads.push_back(
            {.x0 = x, .y0 = -20, .z0 = 0.2, .x1 = x, .y1 = 20, .z1 = 0.2, .width = 0.4F, .arc = -1});
    return toolpath;
}

void addBead(gcode::Toolpath& toolpath, double x0, double y0, double x1, double y1, double z = kZ) {
    toolpath.beads.push_back(
        {.x0 = x0, .y0 = y0, .z0 = z, .x1 = x1, .y1 = y1, .z1 = z, .width = 0.4F, .run = 1, .arc = -9});
}

bool sameBytes(const gcode::Bead& a, const gcode::Bead& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

void expectUntouched(gcode::Toolpath toolpath) {
    const std::vector<gcode::Bead> before = toolpath.beads;
    const SagReport report = sagBeads(toolpath, 0.1);
    EXPECT_EQ(report.spans, 0U);
    EXPECT_EQ(report.length_mm, 0);
    EXPECT_EQ(report.deepest_mm, 0);
    ASSERT_EQ(toolpath.beads.size(), before.size());
    EXPECT_EQ(std::memcmp(toolpath.beads.data(), before.data(), before.size() * sizeof before[0]), 0);
}

double lowest(const gcode::Toolpath& toolpath, std::uint32_t run = 1) {
    double z = 1e300;
    for (const gcode::Bead& bead : toolpath.beads)
        if (bead.run == run) z = std::min({z, double{bead.z0}, double{bead.z1}});
    return z;
}

TEST(Sag, BeadHangsBetweenTwoWalls) {
    gcode::Toolpath toolpath = twoWalls();
    addBead(toolpath, -0.1, 1, 10.1, 1);
    const std::vector<gcode::Bead> before = toolpath.beads;
    const double volume = gcode::beadVolume(toolpath);
    const SagReport report = sagBeads(toolpath, 0.05);
    const double gap = 10 - 2 * kHold;
    EXPECT_EQ(report.spans, 1U);
    EXPECT_NEAR(report.length_mm, gap, 1e-9);
    EXPECT_NEAR(report.deepest_mm, 0.05 * gap, 1e-9);
    EXPECT_NEAR(lowest(toolpath), kZ - 0.05 * gap, 1e-9);
    EXPECT_NEAR(gcode::beadVolume(toolpath), volume, 1e-6 * volume);
    EXPECT_TRUE(sameBytes(toolpath.beads[0], before[0]));
    EXPECT_TRUE(sameBytes(toolpath.beads[1], before[1]));
    ASSERT_GE(toolpath.beads.size(), 6U);
    EXPECT_LE(toolpath.beads.size(), 2U + 32 + 2);
    for (std::size_t n = 2; n < toolpath.beads.size(); ++n) {
        const gcode::Bead& bead = toolpath.beads[n];
        EXPECT_EQ(toolpath.lineOf(bead), 9U);
        if (n > 2) {
            EXPECT_EQ(double{bead.x0}, double{toolpath.beads[n - 1].x1});
            EXPECT_EQ(double{bead.z0}, double{toolpath.beads[n - 1].z1});
        }
        for (const double t : {0.0, 0.5, 1.0}) {
            const double s = std::clamp(std::lerp(double{bead.x0}, double{bead.x1}, t) - kHold, 0.0, gap);
            const double z = kZ - 0.05 * 4 * s * (gap - s) / gap;
            EXPECT_NEAR(std::lerp(double{bead.z0}, double{bead.z1}, t), z, 0.01 * 0.2 * 1.01);
        }
    }
    EXPECT_EQ(double{toolpath.beads[2].z1}, kZ);
    EXPECT_NEAR(toolpath.beads[2].x1, kHold, 1e-9);
    EXPECT_EQ(toolpath.beads[2].width, 0.4F);
    EXPECT_EQ(double{toolpath.beads.back().z0}, kZ);
    EXPECT_NEAR(toolpath.beads.back().x0, 10 - kHold, 1e-9);
    EXPECT_EQ(double{toolpath.beads.back().x1}, 10.1);
}

TEST(Sag, ThickBridgesHang) {
    gcode::Toolpath toolpath = twoWalls();
    toolpath.runs[1].height = 0.4F;
    toolpath.beads[0].z0 = toolpath.beads[0].z1 = toolpath.beads[1].z0 = toolpath.beads[1].z1 = 0.4;
    toolpath.runs.push_back({.height = 0.2F, .layer = 1});
    for (const double x : {0.0, 10.0})
        toolpath.beads.push_back({.x0 = x, .z0 = 0.2, .x1 = x, .z1 = 0.2, .width = 0.4F, .run = 2, .arc = -1});
    addBead(toolpath, 0, 1, 10, 1, 0.6);
    EXPECT_EQ(sagBeads(toolpath, 0.02).spans, 1U);
}

TEST(Sag, LooseEndsAndLoopsStay) {
    gcode::Toolpath cantilever = twoWalls();
    addBead(cantilever, 0, 1, 8, 1);
    expectUntouched(cantilever);
    gcode::Toolpath loop = twoWalls();
    addBead(loop, 3, 1, 7, 1);
    addBead(loop, 7, 1, 7, 4);
    addBead(loop, 7, 4, 3, 1);
    expectUntouched(loop);
    gcode::Toolpath circle = twoWalls();
    addBead(circle, 3, 1, 3, 1);
    circle.arcs.push_back({5, 1, 2 * std::numbers::pi, 7});
    circle.beads.back().arc = 0;
    expectUntouched(circle);
    gcode::Toolpath sloped = twoWalls();
    addBead(sloped, 0, 1, 10, 1);
    sloped.beads.back().z1 = 0.41;
    expectUntouched(sloped);
    gcode::Toolpath firstLayer = twoWalls();
    addBead(firstLayer, 0, 1, 10, 1);
    firstLayer.beads.back().run = 0;
    firstLayer.beads.back().z0 = firstLayer.beads.back().z1 = 5;
    expectUntouched(firstLayer);
}

TEST(Sag, LinesBesideASupportedOneStay) {
    // A third wall along x carries the first of three parallel lines; with it, that holds the second.
    for (const bool wall : {false, true}) {
        gcode::Toolpath toolpath = twoWalls();
        if (wall) {
            toolpath.beads.push_back(toolpath.beads[0]);
            toolpath.beads[2].x1 = 10;
            toolpath.beads[2].y0 = toolpath.beads[2].y1 = 1;
        }
        for (const double y : {1.2, 1.6, 2.0}) addBead(toolpath, 0, y, 10, y);
        EXPECT_EQ(sagBeads(toolpath, 0.02).spans, wall ? 1U : 3U);
    }
}

TEST(Sag, SpansShorterThanABeadIsWideStay) {
    for (const double gap : {0.35, 0.45}) {
        gcode::Toolpath toolpath = twoWalls();
        toolpath.beads[1].x0 = toolpath.beads[1].x1 = 2 * kHold + gap;
        addBead(toolpath, 0, 1, 2 * kHold + gap, 1);
        if (gap < 0.4)
            expectUntouched(toolpath);
        else
            EXPECT_EQ(sagBeads(toolpath, 0.1).spans, 1U);
    }
}

TEST(Sag, ChainIsOneSpan) {
    gcode::Toolpath toolpath = twoWalls();
    addBead(toolpath, 0, 1, 3, 1);
    addBead(toolpath, 3.0005, 1, 6, 1);  // rounded
    addBead(toolpath, 6, 1, 6, 1);       // of no length
    addBead(toolpath, 6, 1, 10, 1);
    const double volume = gcode::beadVolume(toolpath);
    const SagReport report = sagBeads(toolpath, 0.05);
    EXPECT_EQ(report.spans, 1U);
    EXPECT_NEAR(report.length_mm, 10 - 2 * kHold, 1e-3);
    EXPECT_NEAR(lowest(toolpath), kZ - report.deepest_mm, 1e-6);
    EXPECT_NEAR(gcode::beadVolume(toolpath), volume, 1e-6 * volume);
    bool disc = false;
    for (std::size_t n = 3; n < toolpath.beads.size(); ++n) {
        const gcode::Bead& bead = toolpath.beads[n];
        EXPECT_NEAR(bead.z0, toolpath.beads[n - 1].z1, 1e-12);
        if (bead.x0 == bead.x1) {
            disc = true;
            EXPECT_LT(bead.z0, kZ - 0.1);
            EXPECT_EQ(bead.width, 0.4F);
        }
    }
    EXPECT_TRUE(disc);
    // A travel between two beads leaves two loose ends.
    gcode::Toolpath apart = twoWalls();
    addBead(apart, 0, 1, 3, 1);
    addBead(apart, 3.01, 1, 10, 1);
    expectUntouched(apart);
}

TEST(Sag, TurnsOnAWallDivideSpans) {
    gcode::Toolpath toolpath = twoWalls();
    double x = 0;
    for (int line = 0; line < 5; ++line) {
        addBead(toolpath, x, line, 10 - x, line);
        x = 10 - x;
        addBead(toolpath, x, line, x, line + 1);
    }
    const std::vector<gcode::Bead> before = toolpath.beads;
    const SagReport report = sagBeads(toolpath, 0.02);
    EXPECT_EQ(report.spans, 5U);
    EXPECT_NEAR(report.length_mm, 5 * (10 - 2 * kHold), 1e-6);
    for (std::size_t n = 3; n < before.size(); n += 2)
        EXPECT_TRUE(std::any_of(toolpath.beads.begin(), toolpath.beads.end(),
                                [&](const gcode::Bead& bead) { return sameBytes(bead, before[n]); }));
}

TEST(Sag, ArcsHang) {
    gcode::Toolpath toolpath = twoWalls();
    addBead(toolpath, 0, 1, 10, 1);
    toolpath.arcs.push_back({5, 1, std::numbers::pi, 7});
    toolpath.beads.back().arc = 0;
    addBead(toolpath, 0, 1, 0, 2);
    const double volume = gcode::beadVolume(toolpath);
    const SagReport report = sagBeads(toolpath, 0.05);
    EXPECT_EQ(report.spans, 1U);
    // Where the half circle is kHold from a wall.
    const double held = 5 * std::acos((5 - kHold) / 5);
    EXPECT_NEAR(report.length_mm, 5 * std::numbers::pi - 2 * held, 1e-4);
    EXPECT_NEAR(lowest(toolpath), kZ - report.deepest_mm, 1e-9);
    EXPECT_NEAR(gcode::beadVolume(toolpath), volume, 1e-6 * volume);
    double low_x = 0;
    for (const gcode::Bead& bead : toolpath.beads) {
        if (bead.arc >= 0) {
            EXPECT_NEAR(std::hypot(bead.x1 - 5, bead.y1 - 1), 5, 1e-9);
        }
        if (bead.run == 1 && std::abs(bead.z1 - lowest(toolpath)) < 1e-12) low_x = bead.x1;
    }
    EXPECT_NEAR(low_x, 5, 1e-5);
}

TEST(Sag, FlowAndTimeAreDivided) {
    gcode::Toolpath toolpath = twoWalls();
    addBead(toolpath, -1, 1, 10, 1);
    toolpath.flow = {{1, 2, 0}, {1, 2, 0}, {0.9F, 3, 0.2F}};
    toolpath.timing = {{0, 1, 5, 10, 6}, {1, 1, 5, 10, 6}, {2, 4, 5, 10, 6}};
    sagBeads(toolpath, 0.05);
    ASSERT_EQ(toolpath.flow.size(), toolpath.beads.size());
    ASSERT_EQ(toolpath.timing.size(), toolpath.beads.size());
    double volume = 0;
    double seconds = 0;
    double section = 0;
    for (std::size_t n = 2; n < toolpath.beads.size(); ++n) {
        volume += double{toolpath.flow[n].volume};
        section += gcode::beadVolume(toolpath, toolpath.beads[n]);
        EXPECT_EQ(toolpath.flow[n].rate, 3);
        EXPECT_NEAR(toolpath.timing[n].start, 2 + seconds, 1e-6);
        seconds += double{toolpath.timing[n].seconds};
        EXPECT_EQ(toolpath.timing[n].entry, n == 2 ? 5 : 10);
        EXPECT_EQ(toolpath.timing[n].exit, n + 1 == toolpath.beads.size() ? 6 : 10);
        const bool level = double{toolpath.beads[n].z0} == double{toolpath.beads[n].z1};
        const double share = (toolpath.beads[n].x1 - toolpath.beads[n].x0) / 11;
        EXPECT_NEAR(toolpath.flow[n].widening, level ? 0.2 * share : 0, 1e-6);
        EXPECT_GT(toolpath.beads[n].width, 0.3F);
    }
    EXPECT_NEAR(volume, 0.9, 1e-6);
    EXPECT_NEAR(seconds, 4, 1e-5);
    EXPECT_NEAR(section, gcode::sectionArea(double{0.4F}, double{0.2F}) * 11, 1e-6);
    EXPECT_LT(toolpath.beads[2].width, 0.33F);  // the narrow end
    EXPECT_GT(toolpath.beads.back().width, 0.48F);
    EXPECT_EQ(toolpath.flow[0].volume, 1);
    EXPECT_EQ(toolpath.timing[1].exit, 6);
}

TEST(Sag, SlopesStayBelow45Degrees) {
    for (const double fraction : {0.2, 0.25, 0.3, 0.5, 7.0, std::numeric_limits<double>::infinity()}) {
        gcode::Toolpath toolpath = twoWalls();
        addBead(toolpath, 0, 1, 4, 1);
        addBead(toolpath, 4, 1, 10, 1);
        const double volume = gcode::beadVolume(toolpath);
        const SagReport report = sagBeads(toolpath, fraction);
        EXPECT_NEAR(report.deepest_mm, std::min(fraction, 0.495) * report.length_mm, 1e-9);
        EXPECT_NEAR(lowest(toolpath), kZ - report.deepest_mm, 1e-9);
        for (const gcode::Bead& bead : toolpath.beads)
            EXPECT_LE(std::abs(bead.z1 - bead.z0), 0.99 * std::hypot(bead.x1 - bead.x0, bead.y1 - bead.y0) + 1e-9);
        EXPECT_NEAR(gcode::beadVolume(toolpath), volume, 1e-6 * volume);
    }
    for (const double fraction : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
        gcode::Toolpath toolpath = twoWalls();
        addBead(toolpath, 0, 1, 10, 1);
        EXPECT_EQ(sagBeads(toolpath, fraction).spans, 0U);
        EXPECT_EQ(toolpath.beads.size(), 3U);
    }
}

TEST(Sag, OddBeadsDoNoHarm) {
    gcode::Toolpath empty;
    EXPECT_EQ(sagBeads(empty, 0.1).spans, 0U);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    std::mt19937 random(5);
    std::uniform_int_distribution<int> place(0, 12);
    for (int trial = 0; trial < 200; ++trial) {
        gcode::Toolpath toolpath = twoWalls();
        double x = 0;
        double y = 0;
        // A path on a coarse lattice meets and repeats itself.
        for (int n = 0; n < 40; ++n) {
            const double to_x = place(random);
            const double to_y = place(random) / 4;
            addBead(toolpath, x, y, to_x, to_y);
            if (n % 7 == 0) toolpath.beads.push_back(toolpath.beads.back());
            if (n % 9 == 0) addBead(toolpath, to_x, to_y, to_x, to_y);
            if (n % 11 == 10) addBead(toolpath, to_x, nan, to_x, nan, n % 2 ? nan : kZ);
            x = to_x;
            y = to_y;
        }
        double volume = 0;
        for (const gcode::Bead& bead : toolpath.beads)
            if (const double one = gcode::beadVolume(toolpath, bead); one >= 0) volume += one;
        sagBeads(toolpath, 0.1);
        EXPECT_LT(toolpath.beads.size(), 4000U);
        double after = 0;
        for (const gcode::Bead& bead : toolpath.beads)
            if (const double one = gcode::beadVolume(toolpath, bead); one >= 0) after += one;
        EXPECT_NEAR(after, volume, 1e-6 * volume);
    }
}

TEST(Sag, BridgesOfARealPrintHang) {
    const InputFile file(test::dataDir() / "gcode" / "bridges.gcode");
    gcode::Toolpath toolpath = gcode::readToolpath(file.bytes(), "bridges.gcode");
    const gcode::Toolpath before = toolpath;
    const SagReport report = sagBeads(toolpath, 0.02);
    EXPECT_GT(report.spans, 10U);
    std::size_t bridges = 0;
    for (const gcode::Bead& bead : toolpath.beads) {
        if (double{bead.z0} == double{bead.z1}) continue;
        const gcode::Run& run = toolpath.runOf(bead);
        EXPECT_GT(run.layer, 1U);
        if (run.feature == gcode::Feature::bridge) ++bridges;
    }
    EXPECT_GT(bridges, 100U);
    const double volume = gcode::beadVolume(before);
    EXPECT_NEAR(gcode::beadVolume(toolpath), volume, 1e-6 * volume);
    std::size_t same = 0;
    while (same < before.beads.size() && sameBytes(before.beads[same], toolpath.beads[same])) ++same;
    EXPECT_GT(toolpath.runOf(toolpath.beads[same]).layer, 1U);
}

}  // namespace
}  // namespace stratum::deposit
