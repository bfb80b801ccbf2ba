#include "march/brick/beam.h"

#include "random_rays.h"
#include "rubble.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <cmath>

namespace stratum::march {
namespace {

// A picture's worth of rays, from one eye.
std::vector<trace::Ray> raysFrom(const glm::dvec3& eye, const glm::dvec3& forward, double width, std::size_t count,
                                 std::mt19937& random) {
    std::uniform_real_distribution<double> offset(-width, width);
    const glm::dvec3 side = std::abs(forward.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, side));
    const glm::dvec3 up = glm::cross(right, forward);
    std::vector<trace::Ray> rays(count);
    for (trace::Ray& ray : rays) {
        ray.origin = eye;
        ray.direction = glm::normalize(forward + offset(random) * right + offset(random) * up);
    }
    return rays;
}

TEST(Beams, NothingLiesBeforeTheirStarts) {
    const auto grid = test::rubble(0.1F, false);
    const BrickGrid bricks(*grid, BrickValues::Int16);
    const CellMap map(*grid->transform().baseMap(), bricks.origin());
    Beams beams(bricks, map);
    std::mt19937 random(8);
    std::size_t known = 0;
    std::size_t misses = 0;
    std::size_t useful = 0;
    for (int n = 0; n < 600; ++n) {
        const glm::dvec3 out = test::randomDirection(random);
        const double away = n % 3 == 0 ? 3.0 : n % 3 == 1 ? 12.0 : 1000.0;  // in the box, near and far
        const double width = n % 5 == 0 ? 0.0 : 3 / away;
        // At it, past it, and away from it; along axes, too.
        glm::dvec3 forward = glm::normalize(-out + 0.3 * test::randomDirection(random));
        if (n % 7 == 0) forward = -forward;
        if (n % 11 == 0) forward = glm::dvec3(0, 0, n % 2 == 0 ? 1 : -1);
        const std::vector<trace::Ray> rays =
            raysFrom(away * out, forward, width, 64 + static_cast<std::size_t>(n), random);
        const auto starts = beams.starts(rays);
        if (starts.empty()) continue;
        ++known;
        ASSERT_EQ(starts.size(), rays.size());
        for (std::size_t r = 0; r < rays.size(); ++r) {
            ASSERT_FALSE(std::isnan(starts[r]));
            Walk walk(map.to_cells * rays[r].origin + map.origin, map.to_cells * rays[r].direction);
            if (!walk.enter(0, std::numeric_limits<double>::infinity(), bricks.size())) continue;
            // No brick before the start.
            bool met = false;
            while (true) {
                const glm::ivec3 c = walk.cell();
                const MacroCell& macro = bricks.macroCell(c.x >> 5, c.y >> 5, c.z >> 5);
                if ((macro.bricks >> Mask64::bit(c.x >> 3 & 3, c.y >> 3 & 3, c.z >> 3 & 3) & 1) != 0) {
                    met = true;
                    break;
                }
                const Block block = findBlock(bricks, c);
                walk.aim(block.low, block.high);
                if (!walk.advance(block.low, block.high, bricks.size())) break;
            }
            if (met) {
                walk.aim(walk.cell(), walk.cell() + 1);
                // A cell earlier along the main axis, unless the ray begins there.
                if (starts[r] > 0) {
                    ASSERT_LT(starts[r], walk.at(0) - 0.5 * 0.1);
                }
                useful += starts[r] > 0 ? 1 : 0;
            }
            misses += std::isinf(starts[r]) ? 1 : 0;
        }
    }
    EXPECT_GT(known, 500U);
    EXPECT_GT(useful, 10000U);
    EXPECT_GT(misses, 4000U);
}

TEST(Beams, KnowNothingOfRaysWithNothingInCommon) {
    const auto grid = test::rubble(0.1F, false);
    const BrickGrid bricks(*grid, BrickValues::Int16);
    const CellMap map(*grid->transform().baseMap(), bricks.origin());
    Beams beams(bricks, map);
    std::mt19937 random(8);
    const std::vector<trace::Ray> good = raysFrom({0, 0, 20}, {0, 0, -1}, 0.1, 200, random);
    EXPECT_FALSE(beams.starts(good).empty());
    EXPECT_TRUE(beams.starts(std::span(good).first(10)).empty());
    for (const std::size_t place : {0U, 1U, 77U, 199U}) {
        std::vector<trace::Ray> rays = good;
        rays[place].origin.x += 1e-9;
        EXPECT_TRUE(beams.starts(rays).empty());
        rays = good;
        rays[place].direction = -rays[place].direction;
        EXPECT_TRUE(beams.starts(rays).empty());
        rays = good;
        rays[place].direction.y = std::numeric_limits<double>::quiet_NaN();
        EXPECT_TRUE(beams.starts(rays).empty());
    }
    std::vector<trace::Ray> rays = good;
    for (trace::Ray& ray : rays) ray.origin.x = std::numeric_limits<double>::infinity();
    EXPECT_TRUE(beams.starts(rays).empty());
}

}  // namespace
}  // namespace stratum::march
