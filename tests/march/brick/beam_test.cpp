#include "march/brick/beam.h"

#include "march/brick/brick_walk.h"
#include "random_rays.h"
#include "rubble.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace stratum::march {
namespace {

// Directions of a picture around `forward`, in cells.
std::vector<glm::dvec3> directions(const glm::dvec3& forward, double width, std::size_t count, std::mt19937& random) {
    std::uniform_real_distribution<double> offset(-width, width);
    const glm::dvec3 side = std::abs(forward.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, side));
    const glm::dvec3 up = glm::cross(right, forward);
    std::vector<glm::dvec3> all(count);
    for (glm::dvec3& one : all) one = glm::normalize(forward + offset(random) * right + offset(random) * up);
    return all;
}

struct Slope {
    double v[2];
};

// Directions with one main axis: their fan, and its slopes; false if they have none.
bool makeFan(const glm::dvec3& eye, const std::vector<glm::dvec3>& rays, RayFan& fan, std::vector<Slope>& slopes) {
    fan = {};
    fan.eye = eye;
    for (int axis = 1; axis < 3; ++axis)
        if (std::abs(rays[0][axis]) > std::abs(rays[0][fan.main])) fan.main = axis;
    fan.forth = rays[0][fan.main] > 0;
    slopes.clear();
    for (const glm::dvec3& ray : rays) {
        if ((ray[fan.main] > 0) != fan.forth || std::abs(ray[fan.main]) < 0.1) return false;
        Slope slope{};
        for (int k = 0; k < 2; ++k) slope.v[k] = ray[(fan.main + 1 + k) % 3] / std::abs(ray[fan.main]);
        slopes.push_back(slope);
    }
    for (int k = 0; k < 2; ++k) {
        fan.low[k] = fan.high[k] = slopes[0].v[k];
        for (const Slope& slope : slopes) {
            fan.low[k] = std::min(fan.low[k], slope.v[k]);
            fan.high[k] = std::max(fan.high[k], slope.v[k]);
        }
    }
    return true;
}

// The distance along the ray at which it enters its first surface cell, and that cell; infinite if there is none.
double firstSurface(const BrickGrid& bricks, const glm::dvec3& eye, const glm::dvec3& direction) {
    Walk walk(eye, direction);
    if (!walk.enter(0, std::numeric_limits<double>::infinity(), bricks.size()))
        return std::numeric_limits<double>::infinity();
    while (true) {
        const Block block = findBlock(bricks, walk.cell(), walk.octant());
        walk.aim(block.low, block.high);
        if (block.surface) return walk.at(0);
        if (!walk.advance(block.low, block.high, bricks.size())) return std::numeric_limits<double>::infinity();
    }
}

TEST(Beams, NoSurfaceCellLiesBeforeTheirPlanes) {
    const auto grid = test::rubble(0.1F, false);
    const BrickGrid bricks(*grid, BrickValues::Int16);
    const CellMap map(*grid->transform().baseMap(), bricks.origin());
    Beams beams(bricks);
    std::mt19937 random(8);
    std::size_t fans = 0;
    std::size_t misses = 0;
    std::size_t close = 0;
    std::size_t hits = 0;
    for (int n = 0; n < 600; ++n) {
        const glm::dvec3 out = test::randomDirection(random);
        const double away = n % 3 == 0 ? 3.0 : n % 3 == 1 ? 12.0 : 1000.0;  // in the box, near and far
        const double width = n % 5 == 0 ? 0.0 : 3 / away;
        // At it, past it, and away from it; along axes, too.
        glm::dvec3 forward = glm::normalize(-out + 0.3 * test::randomDirection(random));
        if (n % 7 == 0) forward = -forward;
        if (n % 11 == 0) forward = glm::dvec3(0, 0, n % 2 == 0 ? 1 : -1);
        const std::vector<glm::dvec3> rays = directions(forward, width, 64 + static_cast<std::size_t>(n), random);
        const glm::dvec3 eye = map.to_cells * (away * out) + map.origin;
        RayFan fan;
        std::vector<Slope> slopes;
        if (!makeFan(eye, rays, fan, slopes)) continue;
        ++fans;
        beams.begin(fan, rays.size());
        const auto beamOf = [&](const Slope& slope) {
            return std::pair(static_cast<int>((slope.v[0] - fan.low[0]) * beams.scale(0)),
                             static_cast<int>((slope.v[1] - fan.low[1]) * beams.scale(1)));
        };
        for (const Slope& slope : slopes) {
            const auto [column, row] = beamOf(slope);
            ASSERT_LT(std::max(column, row), Beams::kMostSide);
            beams.open(static_cast<std::size_t>(row * Beams::kMostSide + column));
        }
        beams.findPlanes();
        for (std::size_t r = 0; r < rays.size(); ++r) {
            const auto [column, row] = beamOf(slopes[r]);
            const double plane = beams.planes()[row * Beams::kMostSide + column];
            const double depth = plane - (fan.forth ? eye[fan.main] : -eye[fan.main]);
            ASSERT_FALSE(std::isnan(depth));
            const double met = firstSurface(bricks, eye, rays[r]) * std::abs(rays[r][fan.main]);
            misses += std::isinf(depth) ? 1 : 0;
            if (std::isinf(met)) continue;
            ++hits;
            ASSERT_LE(depth, met + 1e-9);
            close += met - depth < 8 ? 1 : 0;
        }
    }
    EXPECT_GT(fans, 500U);
    EXPECT_GT(misses, 4000U);
    EXPECT_GT(hits, 30000U);
    // Beams of directions this random are wide; still most end near their rays' first surface cells.
    EXPECT_GT(close, hits / 3);
}

TEST(Beams, WithoutRaysAreNotLookedFor) {
    const auto grid = test::rubble(0.1F, false);
    const BrickGrid bricks(*grid, BrickValues::Int16);
    Beams beams(bricks);
    RayFan fan;
    fan.eye = {-50, 40, 40};
    for (int k = 0; k < 2; ++k) {
        fan.low[k] = -0.5;
        fan.high[k] = 0.5;
    }
    beams.begin(fan, 1024);
    beams.open(8 * Beams::kMostSide + 8);
    beams.findPlanes();
    for (int n = 0; n < Beams::kMostSide * Beams::kMostSide; ++n)
        if (n != 8 * Beams::kMostSide + 8) {
            ASSERT_TRUE(std::isinf(beams.planes()[n])) << n;
        }
}

}  // namespace
}  // namespace stratum::march
