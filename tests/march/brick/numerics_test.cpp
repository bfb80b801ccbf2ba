// The numeric rules that exact, watertight rays rest on, one by one.
#include "march/brick/brick_intersector.h"
#include "march/brick/brick_walk.h"

#include "base/error.h"
#include "brute_march.h"
#include "random_rays.h"
#include "rubble.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <bit>
#include <cmath>

namespace stratum::march {
namespace {

// Rule 1: t restarts at the box, so a far eye costs no more than the rounding of its own numbers.
TEST(Numerics, Rule1_TheEyeMayBeFarAway) {
    const auto intersector = makeBrickIntersector(*test::rubble(0.1F, false));
    const auto tracer = intersector->makeTracer();
    int compared = 0;
    for (trace::Ray ray : test::randomRays(20000, 4, 0.1, 21)) {
        ray.t_min = 0;
        ray.t_max = std::numeric_limits<double>::infinity();
        ray.origin -= (glm::dot(ray.origin, ray.direction) + 20) * ray.direction;  // outside
        trace::Hit near;
        const bool found = tracer->intersect(ray, near);
        for (const double away : {1e3, 1e6}) {
            trace::Ray far = ray;
            far.origin -= away * ray.direction;
            trace::Hit hit;
            const bool still = tracer->intersect(far, hit);
            if (!found || !still) continue;
            // A direction's own rounding, 1e-16, moves a ray by that times the way; tangents make more of it.
            if (std::abs(glm::dot(near.normal, ray.direction)) < 0.05) continue;
            ASSERT_NEAR(hit.t - away, near.t, 1e-7);
            ++compared;
        }
    }
    EXPECT_GT(compared, 10000);
}

// Rule 2: cells are whole numbers, every step goes on, and there are no more steps than cells on the way.
TEST(Numerics, Rule2_EveryStepAdvancesWholeCells) {
    const auto grid = test::rubble(0.1F, true);
    const BrickGrid bricks(*grid, BrickValues::Float32);
    const CellMap map(*grid->transform().baseMap(), bricks.origin());
    const int most = bricks.size()[0] + bricks.size()[1] + bricks.size()[2];
    for (const trace::Ray& ray : test::randomRays(50000, 4, 0.1, 22)) {
        Walk walk(map.to_cells * ray.origin + map.origin, map.to_cells * ray.direction);
        if (!walk.enter(ray.t_min, ray.t_max, bricks.size())) continue;
        int steps = 0;
        glm::ivec3 before = walk.cell();
        while (true) {
            const Block block = findBlock(bricks, walk.cell(), walk.octant());
            ASSERT_TRUE(glm::all(glm::greaterThanEqual(walk.cell(), block.low)));
            ASSERT_TRUE(glm::all(glm::lessThan(walk.cell(), block.high)));
            walk.aim(block.low, block.high);
            if (!walk.advance(block.low, block.high, bricks.size())) break;
            const glm::ivec3 step = walk.cell() - before;
            ASSERT_NE(step, glm::ivec3(0));
            for (int axis = 0; axis < 3; ++axis) ASSERT_GE(step[axis] * ray.direction[axis], 0);
            before = walk.cell();
            ASSERT_LE(++steps, most);
        }
    }
}

// Rule 3: what a ray leaves one cell with is what it enters the next with, to the bit.
TEST(Numerics, Rule3_NeighboursSeeTheSameBitsOnTheirFace) {
    const auto grid = test::rubble(0.1F, true);
    const BrickGrid bricks(*grid, BrickValues::Float32);
    const CellMap map(*grid->transform().baseMap(), bricks.origin());
    const auto accessor = grid->getConstAccessor();
    const auto cornersAt = [&](const glm::ivec3& cell) {
        Corners v;
        for (int c = 0; c < 8; ++c)
            v[static_cast<std::size_t>(c)] = static_cast<double>(accessor.getValue(
                bricks.origin().offsetBy(cell.x + (c >> 2), cell.y + (c >> 1 & 1), cell.z + (c & 1))));
        return v;
    };
    std::size_t faces = 0;
    for (const trace::Ray& ray : test::randomRays(3000, 4, 0.1, 23)) {
        Walk walk(map.to_cells * ray.origin + map.origin, map.to_cells * ray.direction);
        if (!walk.enter(ray.t_min, ray.t_max, bricks.size())) continue;
        while (true) {
            const glm::ivec3 low = walk.cell();
            walk.aim(low, low + 1);
            const double leaving = interpolate(cornersAt(low), walk.localExit());
            if (!walk.advance(low, low + 1, bricks.size())) break;
            const double entering = interpolate(cornersAt(walk.cell()), walk.localEntry());
            ASSERT_EQ(std::bit_cast<std::uint64_t>(leaving), std::bit_cast<std::uint64_t>(entering));
            ++faces;
        }
    }
    EXPECT_GT(faces, 100000U);
}

// Rule 4, a cubic's hidden pair of roots: cell_root_test.cpp, and here in whole grids.
TEST(Numerics, Rule4_RandomRaysMeetWhatTheBruteMarchMeets) {
    const auto grid = test::rubble(0.1F, false);
    for (const BrickValues values : {BrickValues::Float32, BrickValues::Int16}) {
        const auto intersector = makeBrickIntersector(*grid, values);
        const auto tracer = intersector->makeTracer();
        // What 16-bit bricks hold: the field of the rounded samples.
        const auto held = values == BrickValues::Int16 ? test::quantized(*grid) : grid;
        test::BruteMarch brute(*held);
        test::BruteMarch unrounded(*grid);
        int hits = 0;
        int compared = 0;
        for (const trace::Ray& ray : test::randomRays(20000, 4, 0.1, 24)) {
            if (glm::length(ray.origin) > 1e5) continue;  // the oracle's own rounding
            const auto expected = brute(ray);
            trace::Hit hit;
            ASSERT_EQ(tracer->intersect(ray, hit), expected.has_value());
            if (!expected) continue;
            ASSERT_NEAR(hit.t, *expected, 1e-4 * 0.1);
            ++hits;
            // And against the grid itself, where the ray doesn't graze.
            const auto there = unrounded(ray);
            if (!there || std::abs(glm::dot(hit.normal, ray.direction)) < 0.3) continue;
            ASSERT_NEAR(hit.t, *there, 2e-4 * 0.1);
            ++compared;
        }
        EXPECT_GT(hits, 5000);
        EXPECT_GT(compared, 4000);
    }
}

// Rule 5: a thousandth of a voxel clears the surface, or four roundings of the coordinates if that is more.
TEST(Numerics, Rule5_SecondaryRaysLeaveTheirSurface) {
    for (const double away : {0.0, 1e5, 1e9}) {
        const auto grid = test::sphereGrid(3, openvdb::Vec3f(0), 0.1F);
        grid->transform().postTranslate(openvdb::Vec3d(away, -away, away));
        const auto intersector = makeBrickIntersector(*grid);
        EXPECT_GE(intersector->surfaceOffset(), 1e-3 * 0.1 * (1 - 1e-6));
        EXPECT_GE(intersector->surfaceOffset(), 4 * std::numeric_limits<double>::epsilon() * away);
        const auto tracer = intersector->makeTracer();
        const glm::dvec3 center(away, -away, away);
        std::mt19937 random(5);
        int met = 0;
        for (int n = 0; n < 20000; ++n) {
            const glm::dvec3 out = test::randomDirection(random);
            trace::Hit hit;
            ASSERT_TRUE(tracer->intersect({center + 9.0 * out, -out}, hit));
            const glm::dvec3 leave = glm::normalize(hit.normal + 0.95 * test::randomDirection(random));
            met += tracer->occluded({hit.position + intersector->surfaceOffset() * hit.normal, leave}) ? 1 : 0;
        }
        EXPECT_EQ(met, 0) << away;
    }
}

// Rule 6: directions with zeros, of both signs, and so small that 1/d overflows.
TEST(Numerics, Rule6_ZeroComponentsNeverMakeNumbersThatAreNone) {
    const auto intersector = makeBrickIntersector(*test::sphereGrid(3, openvdb::Vec3f(0), 0.1F));
    const auto tracer = intersector->makeTracer();
    for (const double tiny : {0.0, -0.0, 1e-310, -1e-310, 5e-324, 1e-300, -1e-17})
        for (int axis = 0; axis < 3; ++axis)
            for (int plane = -35; plane <= 35; ++plane) {
                trace::Ray ray{glm::dvec3(0.1 * plane), glm::dvec3(tiny)};
                ray.direction[axis] = 1;
                ray.origin[axis] = -50;
                trace::Hit hit;
                const double square = 9 - 2 * 0.01 * plane * plane;
                const bool found = tracer->intersect(ray, hit);
                ASSERT_EQ(found, tracer->occluded(ray));
                ASSERT_TRUE(found || square <= 0.3);
                ASSERT_TRUE(!found || square >= -0.3);
                if (found) {
                    ASSERT_NEAR(hit.t, 50 - std::sqrt(std::max(square, 0.0)), square > 0.3 ? 0.02 : 1);
                }
            }
}

TEST(Numerics, Rule6_TilesAreNeverHits) {
    const auto grid = test::sphereGrid(1, openvdb::Vec3f(0), 0.1F);
    // A tile of inside values with no band around it, and active: neither its faces nor its middle is a surface.
    grid->tree().addTile(1, openvdb::Coord(-1280, 0, 0), -0.3F, true);
    grid->tree().addTile(1, openvdb::Coord(1280, 0, 0), -0.3F, false);
    const auto intersector = makeBrickIntersector(*grid);
    const auto tracer = intersector->makeTracer();
    for (const double x : {-127.0, 129.0}) {
        EXPECT_FALSE(tracer->occluded({{x, 0.4, -50}, {0, 0, 1}}));
        EXPECT_FALSE(tracer->occluded({{x, 0.4, 0.4}, {0, 1, 0}}));
    }
    EXPECT_TRUE(tracer->occluded({{0, 0, -50}, {0, 0, 1}}));
}

TEST(Numerics, Rule6_ThinBandsAreRefused) {
    EXPECT_THROW(makeBrickIntersector(*test::sphereGrid(3, openvdb::Vec3f(0), 0.1F, 1.5F)), InputError);
    EXPECT_NO_THROW(makeBrickIntersector(*test::sphereGrid(3, openvdb::Vec3f(0), 0.1F, 2)));
}

}  // namespace
}  // namespace stratum::march
