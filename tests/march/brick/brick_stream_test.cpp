#include "march/brick/brick_stream.h"

#include "march/brick/brick_grid.h"
#include "march/brick/brick_intersector.h"
#include "march/brick/brick_walk.h"
#include "on_each_target.h"
#include "random_rays.h"
#include "rubble.h"
#include "spheres.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

namespace stratum::march {
namespace {

// Each vector target that this machine has, and the scalar loop that takes their place elsewhere.
class BrickStream : public test::OnEachTarget {
protected:
    static const char* name() { return hwy::TargetName(GetParam()); }
};

INSTANTIATE_TEST_SUITE_P(Targets, BrickStream, test::allTargets(), test::targetName);

bool sameBits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }
bool sameBits(const glm::dvec3& a, const glm::dvec3& b) {
    return sameBits(a.x, b.x) && sameBits(a.y, b.y) && sameBits(a.z, b.z);
}

struct StreamTally {
    std::size_t hits = 0, missed = 0, extra = 0, moved = 0, blocked_wrongly = 0;
};

StreamTally compare(trace::Tracer& tracer, const std::vector<trace::Ray>& rays) {
    std::vector<trace::Hit> hits(rays.size());
    std::vector<std::uint8_t> blocked(rays.size(), 7);
    tracer.intersectStream(rays, hits);
    tracer.occludedStream(rays, blocked);
    StreamTally tally;
    for (std::size_t n = 0; n < rays.size(); ++n) {
        trace::Hit expected;
        const bool found = tracer.intersect(rays[n], expected);
        const bool by_stream = std::isfinite(hits[n].t);
        tally.hits += found ? 1 : 0;
        tally.missed += found && !by_stream ? 1 : 0;
        tally.extra += !found && by_stream ? 1 : 0;
        tally.blocked_wrongly += blocked[n] != (tracer.occluded(rays[n]) ? 1 : 0) ? 1 : 0;
        if (found && by_stream &&
            !(sameBits(hits[n].t, expected.t) && sameBits(hits[n].position, expected.position) &&
              sameBits(hits[n].normal, expected.normal)))
            ++tally.moved;
    }
    return tally;
}

// Newer releases of Highway know newer instruction sets: none of them may fall to the scalar walk.
TEST_P(BrickStream, RunsInVectorsFromAvx2On) {
    const auto sphere = test::sphereGrid(3, openvdb::Vec3f(0), 0.1F);
    const BrickGrid grid(*sphere, BrickValues::Int16);
    const CellMap map(*sphere->transform().baseMap(), grid.origin());
    const bool wide = HWY_ARCH_X86 && GetParam() <= HWY_AVX2;
    EXPECT_EQ(streamIntersect(grid, map, {}, {}), wide) << name();
    EXPECT_EQ(streamOccluded(grid, map, {}, {}), wide) << name();
}

TEST_P(BrickStream, HasTheBitsOfTheScalarWalk) {
    for (const int kind : {0, 1, 2, 3}) {
        const auto intersector = makeBrickIntersector(*test::rubble(0.1F, kind % 2 != 0),
                                                      kind < 2 ? BrickValues::Float32 : BrickValues::Int16);
        const StreamTally tally = compare(*intersector->makeTracer(), test::randomRays(200000, 4, 0.1, 11));
        EXPECT_GT(tally.hits, 60000U);
        EXPECT_EQ(tally.missed, 0U);
        EXPECT_EQ(tally.extra, 0U);
        EXPECT_EQ(tally.moved, 0U);
        EXPECT_EQ(tally.blocked_wrongly, 0U);
    }
}

TEST_P(BrickStream, HasThemForPicturesToo) {
    // Rays of one eye begin where their beams do.
    for (const BrickValues values : {BrickValues::Float32, BrickValues::Int16}) {
        const auto intersector = makeBrickIntersector(*test::rubble(0.1F, true), values);
        const auto tracer = intersector->makeTracer();
        std::mt19937 random(6);
        std::size_t hits = 0;
        for (int view = 0; view < 60; ++view) {
            const glm::dvec3 out = test::randomDirection(random);
            const double away = view % 3 == 0 ? 2.0 : view % 3 == 1 ? 15.0 : 1e4;
            std::vector<trace::Ray> rays(3000);
            for (trace::Ray& ray : rays) {
                ray.origin = away * out;
                ray.direction = glm::normalize(-out + (5 / away) * test::randomDirection(random));
                if (view % 4 == 0) ray.t_min = away - 2;
                if (view % 4 == 1) ray.t_max = away - 1;
            }
            const StreamTally tally = compare(*tracer, rays);
            hits += tally.hits;
            ASSERT_EQ(tally.missed + tally.extra + tally.moved + tally.blocked_wrongly, 0U) << view;
        }
        EXPECT_GT(hits, 40000U);
    }
}

// Signs at random, so that nearly every cell is a surface cell.
openvdb::FloatGrid::Ptr noise() {
    auto grid = openvdb::FloatGrid::create(3.0F);
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    auto accessor = grid->getAccessor();
    std::mt19937 random(3);
    std::uniform_real_distribution<float> value(-1, 1);
    for (int x = -12; x < 12; ++x)
        for (int y = -12; y < 12; ++y)
            for (int z = -12; z < 12; ++z) accessor.setValue({x, y, z}, value(random));
    return grid;
}

// From corners of cells through corners of cells: rays that meet several planes at once, or nearly so by rounding.
TEST_P(BrickStream, HasThemForPicturesAlongEdgesAndCorners) {
    const auto grid = noise();
    for (const bool turned : {false, true}) {
        if (turned) grid->transform().postRotate(0.4, openvdb::math::Y_AXIS);
        const auto intersector = makeBrickIntersector(*grid);
        const auto tracer = intersector->makeTracer();
        const auto toWorld = [&](const glm::ivec3& index) {
            const openvdb::Vec3d p = grid->indexToWorld(openvdb::Coord(index.x, index.y, index.z));
            return glm::dvec3(p.x(), p.y(), p.z());
        };
        std::mt19937 random(14);
        std::uniform_int_distribution<int> where(-12, 12);
        std::uniform_int_distribution<int> step(-4, 4);
        std::size_t hits = 0;
        for (int view = 0; view < 300; ++view) {
            const auto axis = static_cast<glm::length_t>(view % 3);
            glm::ivec3 eye(where(random), where(random), where(random));
            eye[axis] = view % 2 == 0 ? -32 : 32;
            std::vector<trace::Ray> rays(300);
            for (trace::Ray& ray : rays) {
                glm::ivec3 along(step(random), step(random), step(random));
                along[axis] = view % 2 == 0 ? 8 : -8;
                ray.origin = toWorld(eye);
                ray.direction = glm::normalize(toWorld(eye + along) - ray.origin);
            }
            const StreamTally tally = compare(*tracer, rays);
            hits += tally.hits;
            ASSERT_EQ(tally.missed + tally.extra + tally.moved + tally.blocked_wrongly, 0U) << view;
        }
        EXPECT_GT(hits, 20000U);
    }
}

TEST_P(BrickStream, FollowsTheTransform) {
    const auto grid = test::rubble(0.1F, false);
    grid->transform().postRotate(0.7, openvdb::math::X_AXIS);
    grid->transform().postRotate(-0.3, openvdb::math::Z_AXIS);
    grid->transform().postTranslate(openvdb::Vec3d(0.3, -0.2, 0.1));
    const auto intersector = makeBrickIntersector(*grid);
    const StreamTally tally = compare(*intersector->makeTracer(), test::randomRays(50000, 4, 0.1, 12));
    EXPECT_GT(tally.hits, 15000U);
    EXPECT_EQ(tally.missed + tally.extra + tally.moved + tally.blocked_wrongly, 0U);
}

TEST_P(BrickStream, AnswersDependOnTheirOwnRayAlone) {
    const auto intersector = makeBrickIntersector(*test::rubble(0.1F, true));
    const auto tracer = intersector->makeTracer();
    const std::vector<trace::Ray> rays = test::randomRays(20000, 4, 0.1, 13);
    std::vector<trace::Hit> hits(rays.size());
    tracer->intersectStream(rays, hits);
    std::vector<std::size_t> order(rays.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::shuffle(order.begin(), order.end(), std::mt19937(5));
    std::vector<trace::Ray> shuffled;
    for (const std::size_t n : order) shuffled.push_back(rays[n]);
    // In pieces of every small length, so that packets are never, partly and just filled.
    std::vector<trace::Hit> again(rays.size());
    std::size_t length = 0;
    for (std::size_t first = 0; first < rays.size(); first += length, length = (length + 1) % 97)
        tracer->intersectStream(std::span(shuffled).subspan(first, std::min(length, rays.size() - first)),
                                std::span(again).subspan(first, std::min(length, rays.size() - first)));
    for (std::size_t n = 0; n < order.size(); ++n) {
        ASSERT_TRUE(sameBits(again[n].t, hits[order[n]].t));
        ASSERT_TRUE(!std::isfinite(again[n].t) || sameBits(again[n].normal, hits[order[n]].normal));
    }
}

TEST_P(BrickStream, RaysThatAreNoNumbersMiss) {
    const auto intersector = makeBrickIntersector(*test::sphereGrid(3, openvdb::Vec3f(0), 0.1F));
    const auto tracer = intersector->makeTracer();
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    constexpr double kInf = std::numeric_limits<double>::infinity();
    const trace::Ray good{{0, 0, 9}, {0, 0, -1}};
    std::vector<trace::Ray> rays;
    for (const double bad : {kNan, kInf, -kInf})
        for (int place = 0; place < 3; ++place) {
            trace::Ray ray = good;
            ray.origin[place] = bad;
            rays.push_back(ray);
            ray = good;
            ray.direction[place] = bad;
            if (std::isnan(bad)) rays.push_back(ray);
            ray = good;
            ray.t_min = kNan;
            rays.push_back(ray);
            ray = good;
            ray.t_min = kInf;
            rays.push_back(ray);
        }
    rays.push_back({{0, 0, 9}, {0, 0, 0}});
    std::vector<trace::Hit> hits(rays.size());
    std::vector<std::uint8_t> blocked(rays.size(), 7);
    tracer->intersectStream(rays, hits);
    tracer->occludedStream(rays, blocked);
    for (std::size_t n = 0; n < rays.size(); ++n) {
        EXPECT_FALSE(std::isfinite(hits[n].t)) << n;
        EXPECT_EQ(blocked[n], 0) << n;
        trace::Hit hit;
        EXPECT_FALSE(tracer->intersect(rays[n], hit)) << n;
        EXPECT_FALSE(tracer->occluded(rays[n])) << n;
    }
}

TEST_P(BrickStream, CrossesEmptySpaceBetweenFarParts) {
    auto grid = test::sphereGrid(1, openvdb::Vec3f(0), 0.1F);
    openvdb::tools::csgUnion(*grid, *test::sphereGrid(1, openvdb::Vec3f(60, 45, -30), 0.1F));
    const auto intersector = makeBrickIntersector(*grid);
    const StreamTally tally = compare(*intersector->makeTracer(), test::randomRays(50000, 60, 0.1, 14));
    EXPECT_GT(tally.hits, 5U);
    EXPECT_EQ(tally.missed + tally.extra + tally.moved + tally.blocked_wrongly, 0U);
}

// A table of macro cells so large that its entries are prefetched.
TEST_P(BrickStream, HasThemInLargeGrids) {
    const openvdb::Vec3f far(135, 132, -130);
    auto grid = test::sphereGrid(1, openvdb::Vec3f(0), 0.1F);
    openvdb::tools::csgUnion(*grid, *test::sphereGrid(1, far, 0.1F));
    const BrickGrid bricks(*grid, BrickValues::Int16);
    ASSERT_GT(bricks.size()[0] / 32 * (bricks.size()[1] / 32) * (bricks.size()[2] / 32), 1 << 16);
    const auto intersector = makeBrickIntersector(*grid);
    std::mt19937 random(16);
    std::vector<trace::Ray> rays = test::randomRays(40000, 135, 0.1, 15);
    for (std::size_t n = 0; n < rays.size(); n += 2) {
        const glm::dvec3 center = n % 4 == 0 ? glm::dvec3(0.0) : glm::dvec3(far.x(), far.y(), far.z());
        rays[n].direction = glm::normalize(center + 1.2 * test::randomDirection(random) - rays[n].origin);
    }
    const StreamTally tally = compare(*intersector->makeTracer(), rays);
    EXPECT_GT(tally.hits, 1000U);
    EXPECT_EQ(tally.missed + tally.extra + tally.moved + tally.blocked_wrongly, 0U);
}

}  // namespace
}  // namespace stratum::march
