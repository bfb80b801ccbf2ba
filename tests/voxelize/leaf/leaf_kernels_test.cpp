#include "voxelize/leaf/leaf_kernels.h"

#include "toolpaths.h"
#include "voxelize/beads/bead_field.h"

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <cstring>
#include <random>

namespace stratum::voxelize {
namespace {

constexpr double kVoxel = 0.1;
constexpr double kHalfExtent = 3.5 * kVoxel;

// A column's plan field for one bead, and the exact one.
void expectExact(const gcode::Toolpath& toolpath, double x, double y) {
    const gcode::Bead& bead = toolpath.beads[0];
    const ColumnGrid grid(static_cast<float>(kVoxel));
    PlanField d;
    std::fill(std::begin(d.v), std::end(d.v), 1e30f);
    if (const auto arc = arcOf(toolpath, bead)) {
        const LocalArc local[] = {localArc(*arc, 0.125, x, y, kHalfExtent, 1)};
        minimumOfArcs(grid, local, d, nullptr, nullptr);
    } else {
        const LocalLine local[] = {localLine(bead, 0.125, x, y, kHalfExtent, 1)};
        minimumOfLines(grid, local, d, nullptr, nullptr);
    }
    const gcode::PlanPath path(toolpath, bead);
    for (std::size_t c = 0; c < kColumnSamples; ++c) {
        const double exact = path.distance(x + (static_cast<double>(c / 8) - 3.5) * kVoxel,
                                           y + (static_cast<double>(c % 8) - 3.5) * kVoxel) -
                             0.125;
        // Near the path, where it counts, to a micrometre's fraction; far away as floats go.
        ASSERT_NEAR(d.v[c], exact, 1e-6 + 2e-7 * std::abs(exact)) << c << " at " << x << ", " << y;
    }
}

TEST(LeafKernels, LinesAreExactBesideTheColumnHoweverLong) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> near(-2, 2);
    std::uniform_real_distribution<double> far(-2000, 2000);
    for (int n = 0; n < 300; ++n) {
        gcode::Toolpath toolpath;
        const double x = far(random);
        const double y = far(random);
        if (n % 3 == 0) {
            test::addBead(toolpath, x + near(random), y + near(random), 0.2, x + near(random), y + near(random), 0.2,
                          0.45, 0.2);
        } else {
            // Passes the column a metre from its ends.
            const double angle = near(random);
            const double ax = x + near(random) - 1000 * std::cos(angle);
            const double ay = y + near(random) - 1000 * std::sin(angle);
            test::addBead(toolpath, ax, ay, 0.2, ax + 2000 * std::cos(angle), ay + 2000 * std::sin(angle), 0.2, 0.45,
                          0.2);
        }
        expectExact(toolpath, x, y);
    }
}

TEST(LeafKernels, TapersAreExactHoweverLong) {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> near(-2, 2);
    std::uniform_real_distribution<double> unit(0, 1);
    const ColumnGrid grid(static_cast<float>(kVoxel));
    for (int n = 0; n < 400; ++n) {
        gcode::Toolpath toolpath;
        const double x = 200 * unit(random);
        const double y = 200 * unit(random);
        const double length = std::pow(10.0, -1 + 3 * unit(random));
        const double along = n % 3 == 0 ? 0 : n % 3 == 1 ? length : length * unit(random);
        const double angle = 6.28 * unit(random);
        const double ax = x + 0.5 * near(random) - along * std::cos(angle);
        const double ay = y + 0.5 * near(random) - along * std::sin(angle);
        test::addBead(toolpath, ax, ay, 0.2, ax + length * std::cos(angle), ay + length * std::sin(angle), 0.2, 0.45,
                      0.2);
        const double wide = 0.01 + std::min(0.45 * length, 2.0) * unit(random);
        const EndFlats flats = n % 2 == 0 ? EndFlats{0, wide} : EndFlats{wide, 0.01};
        const LocalTaper local[] = {localTaper(toolpath.beads[0], flats, x, y, kHalfExtent, 1)};
        PlanField d;
        std::fill(std::begin(d.v), std::end(d.v), 1e30f);
        minimumOfTapers(grid, local, d, nullptr, nullptr);
        for (std::size_t c = 0; c < kColumnSamples; ++c) {
            const double exact = test::taperOffset(toolpath.beads[0], flats.start, flats.end,
                                                   x + (static_cast<double>(c / 8) - 3.5) * kVoxel,
                                                   y + (static_cast<double>(c % 8) - 3.5) * kVoxel)
                                     .d;
            ASSERT_NEAR(d.v[c], exact, 1e-6 + 3e-7 * std::abs(exact)) << n << " " << c;
        }
    }
}

TEST(LeafKernels, APointIsALine) {
    gcode::Toolpath toolpath;
    test::addBead(toolpath, 3, 4, 0.2, 3, 4, 0.2, 0.45, 0.2);
    expectExact(toolpath, 3.3, 4.2);
}

TEST(LeafKernels, ArcsAreExactFromTinyToNearlyStraight) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int n = 0; n < 600; ++n) {
        gcode::Toolpath toolpath;
        const double radius = std::pow(10.0, -1.5 + 5.5 * unit(random));  // 0.03 mm to 10 m
        const double from = 6.28 * unit(random);
        const double sweep = n % 7 == 0 ? 2 * std::numbers::pi : (unit(random) - 0.5) * 12;
        // The column stands beside a place of the arc, an end of it, or the centre.
        const double cx = 200 * unit(random);
        const double cy = 200 * unit(random);
        test::addArc(toolpath, cx, cy, radius, from, sweep, 0.2, 0.2, 0.45, 0.2);
        const double along = n % 5 == 0 ? 0 : n % 5 == 1 ? 1 : unit(random);
        const double r = n % 11 == 0 ? 0 : radius;
        expectExact(toolpath, cx + r * std::cos(from + along * sweep) + unit(random) - 0.5,
                    cy + r * std::sin(from + along * sweep) + unit(random) - 0.5);
    }
}

TEST(LeafKernels, EveryInstructionSetGivesTheSameBytes) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> where(-1, 1);
    gcode::Toolpath toolpath;
    for (int n = 0; n < 20; ++n) {
        if (n % 2 == 0)
            test::addBead(toolpath, where(random), where(random), 0.2, where(random), where(random), 0.2, 0.45, 0.2);
        else
            test::addArc(toolpath, where(random), where(random), 1 + where(random) / 2, where(random),
                         3 * where(random), 0.2, 0.2, 0.45, 0.2);
    }
    std::vector<LocalLine> lines;
    std::vector<LocalTaper> tapers;
    std::vector<LocalArc> arcs;
    std::vector<std::uint32_t> ids;
    for (const gcode::Bead& bead : toolpath.beads) {
        if (bead.arc < 0)
            lines.push_back(localLine(bead, 0.125, 0.1, 0.2, kHalfExtent, 1));
        else
            arcs.push_back(localArc(gcode::PlanPath(toolpath, bead), 0.125, 0.1, 0.2, kHalfExtent, 1));
        ids.push_back(static_cast<std::uint32_t>(ids.size()));
    }
    for (const gcode::Bead& bead : toolpath.beads)
        if (bead.arc < 0) tapers.push_back(localTaper(bead, {0.05, 0.1}, 0.1, 0.2, kHalfExtent, 1));
    struct Result {
        PlanField d, sides2, weld;
        PlanOwners owners;
        LeafPlanes planes;
        float values[512];
        std::uint64_t mask[8], above[8];
    };
    const ColumnGrid grid(static_cast<float>(kVoxel));
    std::vector<Result> results;
    std::string names;
    std::int64_t targets = hwy::SupportedTargets() & ~HWY_DISABLED_TARGETS;
    for (std::int64_t rest = targets; rest != 0; rest &= rest - 1) {
        hwy::SetSupportedTargetsForTest(rest & -rest);
        Result r{};
        std::fill(std::begin(r.d.v), std::end(r.d.v), 1e30f);
        minimumOfLines(grid, lines, r.d, ids.data(), &r.owners);
        minimumOfTapers(grid, tapers, r.d, ids.data(), &r.owners);
        minimumOfArcs(grid, arcs, r.d, ids.data(), &r.owners);
        squaredSides(r.d, r.sides2);
        maximumOf(r.d, r.sides2, r.weld);
        LeafTerms leaf;
        for (std::size_t z = 0; z < kLeafPlanes; ++z) {
            const auto dz = static_cast<float>(0.07 * static_cast<double>(z) - 0.2);
            // Two layers of one radius, one of another, and a weld; nothing at all in one plane.
            if (z != 5) {
                const auto first = static_cast<std::uint32_t>(leaf.terms.size());
                leaf.terms.push_back({&r.sides2, dz * dz});
                leaf.terms.push_back({&r.sides2, 0.01f});
                leaf.terms.push_back({&r.sides2, 0.04f});
                leaf.groups.push_back({first, first + 2, 0.1f});
                leaf.groups.push_back({first + 2, first + 3, 0.12f});
                leaf.terms.push_back({&r.sides2, 0.0009f, &r.d, 0.03f});
                leaf.terms.push_back({&r.sides2, 0, &r.d, -0.02f});
                leaf.groups.push_back({first + 3, first + 5, 0.04f, true});
                leaf.welds.push_back({&r.weld, -0.01f * static_cast<float>(z + 1)});
            }
            leaf.group_end[z] = static_cast<std::uint32_t>(leaf.groups.size());
            leaf.weld_end[z] = static_cast<std::uint32_t>(leaf.welds.size());
        }
        expandLayers(leaf, 0.3f, r.planes);
        for (const float value : r.planes.plane[5].v) EXPECT_EQ(value, 0.3f);
        for (std::size_t z = 0; z < kLeafPlanes; ++z) {
            const auto dz = static_cast<float>(0.07 * static_cast<double>(z) - 0.2);
            LocalRod rod{};
            rod.nx = 0.6f, rod.ny = 0.8f, rod.n0 = 0.1f, rod.bz = 1, rod.ux = 0.8f, rod.uy = -0.6f, rod.lo = -0.1f,
            rod.hi = 0.2f, rod.radius = 0.05f;
            expandRod(grid, rod, dz, r.planes.plane[z]);
            PlanField d;
            PlanField sides;
            PlanField center;
            slopedLine(grid, lines[0], 0.05f, 0.3f, d, center);
            squaredSides(d, sides);
            expandSloped(sides, center, {0.9f, 0.004f, 0.1f, 0}, dz, r.planes.plane[z]);
            expandSlopedSides(d, center, {0.9f, 0.004f, 0.03f, 0.05f}, dz, r.planes.plane[z]);
        }
        EXPECT_EQ(clampLeaf(r.planes, kLeafPlanes, 0.3f), LeafContent::surface);
        storeLeaf(r.planes, r.values);
        maskWithin(r.values, 0.3f, r.mask);
        maskFrom(r.values, 0.05f, r.above);
        names += std::string(kernelTarget()) + " ";
        results.push_back(r);
    }
    hwy::SetSupportedTargetsForTest(0);
    for (const Result& r : results) {
        EXPECT_EQ(std::memcmp(r.values, results[0].values, sizeof r.values), 0) << names;
        EXPECT_EQ(std::memcmp(r.mask, results[0].mask, sizeof r.mask), 0) << names;
        EXPECT_EQ(std::memcmp(r.above, results[0].above, sizeof r.above), 0) << names;
        EXPECT_EQ(std::memcmp(&r.owners, &results[0].owners, sizeof r.owners), 0) << names;
    }
    for (std::size_t n = 0; n < 512; ++n) {
        EXPECT_EQ(results[0].mask[n / 64] >> n % 64 & 1, std::abs(results[0].values[n]) < 0.3f ? 1U : 0U);
        EXPECT_EQ(results[0].above[n / 64] >> n % 64 & 1, results[0].values[n] >= 0.05f ? 1U : 0U);
        EXPECT_EQ(results[0].values[n], results[0].planes.plane[n % 8].v[n / 8]);
    }
    RecordProperty("targets", names);
    EXPECT_GE(results.size(), 1U);
}

}  // namespace
}  // namespace stratum::voxelize
