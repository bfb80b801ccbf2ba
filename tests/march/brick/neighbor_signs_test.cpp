#include "march/brick/neighbor_signs.h"

#include "march/brick/brick_grid.h"
#include "march/brick/brick_walk.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <utility>
#include <vector>

namespace stratum::march {
namespace {

constexpr float kBackground = 3;

struct Ball {
    glm::dvec3 center;
    double radius;
};

/// Balls in a box of 32^3 voxels of 1: exact distances outside, never deeper than the surface is near inside.
class Balls final : public LeafField {
public:
    Balls(std::vector<Ball> balls, double slack) : balls_(std::move(balls)), slack_(slack) {
        map_.macros = {1, 1, 1};
        map_.masks = {~std::uint64_t{0}};
    }

    const BrickMap& bricks() const override { return map_; }
    bool samples(const openvdb::Coord& origin, FieldSamples& out) const override {
        ++made_;
        bool any = false;
        for (int x = 0; x < 8; ++x)
            for (int y = 0; y < 8; ++y)
                for (int z = 0; z < 9; ++z) {
                    const float value = at({origin[0] + x, origin[1] + y, origin[2] + z});
                    any = any || value < kBackground;
                    auto& to = z < 8 ? out.leaf[static_cast<std::size_t>(x * 64 + y * 8 + z)]
                                     : out.above[static_cast<std::size_t>(x * 8 + y)];
                    to = value;
                }
        return any;
    }
    float background() const override { return kBackground; }
    double signSlack() const override { return slack_; }
    const openvdb::math::Transform& transform() const override { return *transform_; }
    openvdb::CoordBBox activeBox() const override { return {openvdb::Coord(0), openvdb::Coord(31)}; }
    std::string name() const override { return "balls"; }
    std::size_t bytes() const override { return 0; }

    std::size_t made() const { return made_; }

private:
    float at(const glm::dvec3& p) const {
        double least = kBackground;
        for (const Ball& ball : balls_) least = std::min(least, glm::length(p - ball.center) - ball.radius);
        return static_cast<float>(std::max(least, -double{kBackground}));
    }

    std::vector<Ball> balls_;
    double slack_;
    BrickMap map_;
    openvdb::math::Transform::Ptr transform_ = openvdb::math::Transform::createLinearTransform(1);
    mutable std::atomic<std::size_t> made_{0};
};

// Every surface cell and its corners, with the neighbours' samples and without those that can be done without. Returns
// how many leaves each took.
std::pair<std::size_t, std::size_t> compare(const std::vector<Ball>& balls, BrickValues values) {
    const auto exact = std::make_shared<const Balls>(balls, 1e-4);
    const auto unknown = std::make_shared<const Balls>(balls, std::numeric_limits<double>::infinity());
    const BrickGrid some(std::static_pointer_cast<const LeafField>(exact), values);
    const BrickGrid all(std::static_pointer_cast<const LeafField>(unknown), values);
    std::size_t wrong = 0;
    for (int x = 0; x < 32; ++x)
        for (int y = 0; y < 32; ++y)
            for (int z = 0; z < 32; ++z) {
                const Block a = findBlock(some, {x, y, z});
                const Block b = findBlock(all, {x, y, z});
                if (a.surface != b.surface ||
                    (a.surface && cornersOf(some, a.brick, {x, y, z}) != cornersOf(all, b.brick, {x, y, z})))
                    ++wrong;
            }
    EXPECT_EQ(wrong, 0U);
    return {exact->made(), unknown->made()};
}

class NeighborSignsOf : public testing::TestWithParam<BrickValues> {};
INSTANTIATE_TEST_SUITE_P(Values, NeighborSignsOf, testing::Values(BrickValues::Float32, BrickValues::Int16),
                         [](const auto& values) { return values.param == BrickValues::Float32 ? "Float32" : "Int16"; });

TEST_P(NeighborSignsOf, TakeNoSurfaceCellAway) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> where(-4, 36);
    std::uniform_real_distribution<double> size(0.05, 5);
    std::size_t some = 0;
    std::size_t all = 0;
    for (int n = 0; n < 40; ++n) {
        std::vector<Ball> balls(1 + static_cast<std::size_t>(n) % 12);
        for (Ball& ball : balls) ball = {{where(random), where(random), where(random)}, size(random)};
        const auto [with, without] = compare(balls, GetParam());
        some += with;
        all += without;
    }
    EXPECT_LT(some, all);
}

// One sample of the diagonal neighbour is inside: it is a corner of the cells of all four.
TEST_P(NeighborSignsOf, SeeOneSampleBeyondTheEdge) {
    for (const double radius : {0.02, 0.3, 0.9})
        for (int z = 7; z <= 9; ++z) compare({{{8, 8, static_cast<double>(z)}, radius}}, GetParam());
}

TEST_P(NeighborSignsOf, NeedNoNeighbourOfEmptySpace) {
    const auto [with, without] = compare({{{100, 100, 100}, 1}}, GetParam());
    EXPECT_EQ(with, 64U);
    EXPECT_GT(without, 64U);
}

}  // namespace
}  // namespace stratum::march
