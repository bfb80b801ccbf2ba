#include "voxelize/leaf/settling_kernels.h"

#include "toolpaths.h"
#include "voxelize/beads/bead_field.h"

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <cmath>
#include <cstring>
#include <numeric>
#include <random>

namespace stratum::voxelize {
namespace {

constexpr double kGrooveVoxel = 0.05;
constexpr double kGrooveExtent = 3.5 * kGrooveVoxel;
constexpr double kHalfFlat = 0.125;

gcode::Toolpath randomBeads(int count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> where(-1, 1);
    gcode::Toolpath toolpath;
    for (int n = 0; n < count; ++n) {
        if (n % 3 != 2)
            test::addBead(toolpath, where(random), where(random), 0.2, where(random), where(random), 0.2, 0.45, 0.2);
        else
            test::addArc(toolpath, where(random), where(random), 0.6 + 0.5 * where(random), where(random),
                         3 * where(random) + 0.1, 0.2, 0.2, 0.45, 0.2);
    }
    return toolpath;
}

BeadPlan planOf(const ColumnGrid& grid, const gcode::Toolpath& toolpath, const gcode::Bead& bead) {
    BeadPlan plan;
    if (bead.arc < 0)
        planOfLine(grid, localLine(bead, kHalfFlat, 0, 0, kGrooveExtent, 1), plan);
    else
        planOfArc(grid, localArc(gcode::PlanPath(toolpath, bead), kHalfFlat, 0, 0, kGrooveExtent, 1), plan);
    return plan;
}

TEST(SettlingKernels, DistancesAndDirectionsAreThoseOfThePath) {
    const ColumnGrid grid(static_cast<float>(kGrooveVoxel));
    const gcode::Toolpath toolpath = randomBeads(300);
    for (const gcode::Bead& bead : toolpath.beads) {
        const BeadPlan plan = planOf(grid, toolpath, bead);
        const gcode::PlanPath path(toolpath, bead);
        double least = 1e9;
        for (std::size_t c = 0; c < kColumnSamples; ++c) {
            const double x = (static_cast<double>(c / 8) - 3.5) * kGrooveVoxel;
            const double y = (static_cast<double>(c % 8) - 3.5) * kGrooveVoxel;
            const double rho = path.distance(x, y);
            least = std::min(least, rho - kHalfFlat);
            ASSERT_NEAR(plan.d.v[c], rho - kHalfFlat, 1e-6);
            // The gradient of the distance, where it has one.
            constexpr double kStep = 1e-5;
            const double gx = (path.distance(x + kStep, y) - path.distance(x - kStep, y)) / (2 * kStep);
            const double gy = (path.distance(x, y + kStep) - path.distance(x, y - kStep)) / (2 * kStep);
            if (rho < 0.01 || std::abs(std::hypot(gx, gy) - 1) > 1e-3) continue;
            ASSERT_NEAR(plan.nx.v[c], gx, 2e-3) << bead.arc;
            ASSERT_NEAR(plan.ny.v[c], gy, 2e-3) << bead.arc;
        }
        EXPECT_NEAR(plan.least, std::max(least, 0.0), 1e-6);
    }
}

TEST(SettlingKernels, BeadsThatMayNotFillAreTooFar) {
    const SettlingCurve curve(2, 0.02);
    const GrooveRule rule(curve, 0.1);
    const ColumnGrid grid(static_cast<float>(kGrooveVoxel));
    std::size_t left_out = 0;
    for (const gcode::Bead& bead : randomBeads(3000).beads) {
        if (bead.arc >= 0) continue;
        const LocalLine line = localLine(bead, kHalfFlat, 0, 0, kGrooveExtent, 1);
        if (mayFill(line, rule, kGrooveExtent)) continue;
        ++left_out;
        BeadPlan plan;
        planOfLine(grid, line, plan);
        EXPECT_GE(plan.least, 2 * rule.radius);
    }
    EXPECT_GT(left_out, 100U);
}

// More beads than are looked at together, and each pair alone.
TEST(SettlingKernels, LevelsAreTheLowestOfAllPairs) {
    const gcode::Toolpath toolpath = randomBeads(150);
    const SettlingCurve curve(3, 0.02);
    const GrooveRule rule(curve, 0.07);
    const ColumnGrid grid(static_cast<float>(kGrooveVoxel));
    std::vector<BeadPlan> plans;
    std::vector<std::uint32_t> which;
    for (const gcode::Bead& bead : toolpath.beads) {
        if (plans.size() % 5 != 1) which.push_back(static_cast<std::uint32_t>(plans.size()));
        plans.push_back(planOf(grid, toolpath, bead));
    }
    PlanField d;
    std::fill(std::begin(d.v), std::end(d.v), 0.01F);
    PlanField levels;
    levelsBetween(plans, which, d, rule, levels);
    PlanField expected;
    std::fill(std::begin(expected.v), std::end(expected.v), kNoGroove);
    for (std::size_t a = 0; a < which.size(); ++a)
        for (std::size_t b = a + 1; b < which.size(); ++b) {
            PlanField pair;
            const std::uint32_t two[] = {which[a], which[b]};
            levelsBetween(plans, two, d, rule, pair);
            for (std::size_t c = 0; c < kColumnSamples; ++c) expected.v[c] = std::min(expected.v[c], pair.v[c]);
        }
    EXPECT_EQ(std::memcmp(&levels, &expected, sizeof levels), 0);
    EXPECT_LT(*std::min_element(std::begin(levels.v), std::end(levels.v)), 0.07F);
}

TEST(SettlingKernels, EveryInstructionSetGivesTheSameBytes) {
    const gcode::Toolpath toolpath = randomBeads(14);
    const SettlingCurve curve(3, 0.02);
    const GrooveRule rule(curve, 0.07);
    const ColumnGrid grid(static_cast<float>(kGrooveVoxel));
    struct Result {
        PlanField levels, d, sides2;
        float least;
    };
    std::vector<Result> results;
    std::string names;
    for (std::int64_t rest = hwy::SupportedTargets() & ~HWY_DISABLED_TARGETS; rest != 0; rest &= rest - 1) {
        hwy::SetSupportedTargetsForTest(rest & -rest);
        Result r{};
        std::vector<BeadPlan> plans;
        for (const gcode::Bead& bead : toolpath.beads) plans.push_back(planOf(grid, toolpath, bead));
        for (std::size_t c = 0; c < kColumnSamples; ++c) {
            r.d.v[c] = plans[0].d.v[c];
            for (const BeadPlan& plan : plans) r.d.v[c] = std::min(r.d.v[c], plan.d.v[c]);
        }
        std::vector<std::uint32_t> all(plans.size());
        std::iota(all.begin(), all.end(), 0U);
        levelsBetween(plans, all, r.d, rule, r.levels);
        r.least = fillGrooves(r.levels, rule, r.d, r.sides2);
        moveOut(plans[1].d, r.d, r.sides2);
        names += std::string(kernelTarget()) + " ";
        results.push_back(r);
    }
    hwy::SetSupportedTargetsForTest(0);
    std::size_t filled = 0;
    for (const float level : results[0].levels.v) filled += level < kNoGroove ? 1 : 0;
    EXPECT_GT(filled, 3U);
    for (const Result& r : results) EXPECT_EQ(std::memcmp(&r, &results[0], sizeof r), 0) << names;
}

}  // namespace
}  // namespace stratum::voxelize
