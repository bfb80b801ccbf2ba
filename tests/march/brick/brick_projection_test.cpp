#include "march/brick/brick_projection.h"

#include "march/brick/brick_walk.h"
#include "spheres.h"

#include <gtest/gtest.h>

#include <memory>
#include <numeric>

namespace stratum::march {
namespace {

std::size_t sum(const std::vector<std::uint32_t>& counts) {
    return std::accumulate(counts.begin(), counts.end(), std::size_t{0});
}

TEST(BrickProjection, CountsWhatIsListedAndWhatWasTouched) {
    const auto grid = test::sphereGrid(3, openvdb::Vec3f(4, 0, 0), 0.1F);
    const BrickGrid lazy(std::make_shared<GridLeaves>(*grid), BrickValues::Int16);
    for (const int axis : {1, 2}) {
        const BrickProjection nothing = projectBricks(lazy, axis);
        EXPECT_EQ(nothing.width, static_cast<std::size_t>(lazy.size()[0] / 8));
        EXPECT_EQ(nothing.height, static_cast<std::size_t>(lazy.size()[axis == 2 ? 1 : 2] / 8));
        EXPECT_EQ(sum(nothing.listed), lazy.listedCount());
        EXPECT_EQ(sum(nothing.made), 0U);
    }
    // A brick on the sphere's upper left, as the front has it: x small, z large.
    const glm::dvec3 place(4 - 3 * 0.8, 0, 3 * 0.6);
    const openvdb::Coord cell =
        openvdb::Coord::floor(grid->worldToIndex(openvdb::Vec3d(place.x, place.y, place.z))) - lazy.origin();
    bool there = false;
    for (int x = -2; x <= 2; ++x) there = there || findBlock(lazy, {cell[0] + x, cell[1], cell[2]}).surface;
    ASSERT_TRUE(there);
    const BrickProjection front = projectBricks(lazy, 1);
    const BrickProjection above = projectBricks(lazy, 2);
    EXPECT_GE(sum(front.made), 1U);
    EXPECT_LE(sum(front.made), 2U);
    EXPECT_EQ(sum(front.made), sum(above.made));
    for (std::size_t n = 0; n < front.made.size(); ++n) {
        EXPECT_LE(front.made[n], front.listed[n]);
        if (front.made[n] == 0) continue;
        EXPECT_LT(n % front.width, front.width / 2);
        EXPECT_LT(n / front.width, front.height / 2);
    }
}

}  // namespace
}  // namespace stratum::march
