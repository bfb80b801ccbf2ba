#include "trace/box_tree.h"

#include "random_rays.h"

#include <gtest/gtest.h>
#include <glm/common.hpp>

#include <limits>
#include <random>
#include <set>

namespace stratum::trace {
namespace {

/// Of all sizes, on a lattice of 1/4, so that many share faces and rays run along them; some flat, one endless.
std::vector<Box> boxes(int count, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> where(-40, 40);
    std::uniform_int_distribution<int> size(0, 12);
    std::vector<Box> result;
    for (int n = 0; n < count; ++n) {
        const glm::dvec3 low(where(random), where(random), where(random));
        const glm::dvec3 extent(size(random), size(random), size(random));
        result.push_back({0.25 * low, 0.25 * (low + extent)});
    }
    if (count > 20) result[7] = {glm::dvec3(-kInfinity), glm::dvec3(kInfinity)};
    if (count > 20) result[9] = result[11];
    return result;
}

std::multiset<std::uint32_t> met(const BoxTree& tree, const Ray& ray, double t_max) {
    std::multiset<std::uint32_t> result;
    EXPECT_FALSE(tree.visit(BoxTest(ray), t_max, [&](std::uint32_t n) {
        result.insert(n);
        return false;
    }));
    return result;
}

/// Whether they meet, decided without rounding: rays and boxes on the lattice have short binary fractions. Only for
/// directions of 0 and +-1, where t is a difference of coordinates.
bool meetsExactly(const Ray& ray, const Box& box) {
    double near = ray.t_min;
    double far = ray.t_max;
    for (int axis = 0; axis < 3; ++axis) {
        if (ray.direction[axis] == 0.0) {
            if (ray.origin[axis] < box.min[axis] || ray.origin[axis] > box.max[axis]) return false;
            continue;
        }
        const double s = ray.direction[axis];
        const double a = s * (box.min[axis] - ray.origin[axis]);
        const double b = s * (box.max[axis] - ray.origin[axis]);
        near = std::max(near, std::min(a, b));
        far = std::min(far, std::max(a, b));
    }
    return near <= far;
}

TEST(BoxTree, ListsWhatTheLoopLists) {
    for (const int count : {0, 1, 2, 3, 7, 64, 501}) {
        const std::vector<Box> all = boxes(count, 3);
        const BoxTree tree(all);
        std::size_t pairs = 0;
        for (const Ray& ray : test::randomRays(4000, 10.0, 0.25, 5)) {
            for (const double t_max : {ray.t_max, 12.0}) {
                std::multiset<std::uint32_t> loop;
                for (std::uint32_t n = 0; n < all.size(); ++n)
                    if (BoxTest(ray).meets(all[n], t_max)) loop.insert(n);
                ASSERT_EQ(met(tree, ray, t_max), loop);
                pairs += loop.size();
            }
        }
        if (count > 3) {
            EXPECT_GT(pairs, 50u) << count;
        }
    }
}

TEST(BoxTree, RaysOnFacesMeetThem) {
    const std::vector<Box> all = boxes(200, 8);
    const BoxTree tree(all);
    std::mt19937 random(6);
    std::uniform_int_distribution<std::size_t> which(0, all.size() - 1);
    std::uniform_int_distribution<int> step(-48, 48);
    int on_faces = 0;
    for (int n = 0; n < 6000; ++n) {
        // Along an axis, in the planes of two faces of a box: both other coordinates are those of a corner.
        const Box& box = all[which(random)];
        if (!std::isfinite(box.min.x)) continue;
        const int axis = n % 3;
        Ray ray;
        for (int other = 0; other < 3; ++other)
            ray.origin[other] = ((n >> other) & 8) != 0 ? box.min[other] : box.max[other];
        ray.origin[axis] = 0.25 * step(random);
        ray.direction = glm::dvec3((n & 1) != 0 ? -0.0 : 0.0);
        ray.direction[axis] = (n & 64) != 0 ? 1.0 : -1.0;
        if (n % 5 == 0) ray.t_max = 2.5;
        const auto found = met(tree, ray, ray.t_max);
        for (std::uint32_t k = 0; k < all.size(); ++k) {
            if (!std::isfinite(all[k].min.x)) {
                ASSERT_EQ(found.count(k), 1u);
                continue;
            }
            const bool exact = meetsExactly(ray, all[k]);
            // Never too few; and too many by rounding alone, of which there is none on this lattice, but for the
            // margin.
            if (exact) {
                ASSERT_EQ(found.count(k), 1u) << n << " " << k;
            }
            on_faces += exact ? 1 : 0;
        }
    }
    EXPECT_GT(on_faces, 6000);
}

TEST(BoxTree, StopsWhenTold) {
    const std::vector<Box> all = boxes(100, 2);
    const BoxTree tree(all);
    const Ray ray{{-20, 0, 0}, {1, 0, 0}};
    int calls = 0;
    EXPECT_TRUE(tree.visit(BoxTest(ray), kInfinity, [&](std::uint32_t) { return ++calls == 2; }));
    EXPECT_EQ(calls, 2);
}

TEST(BoxTree, NonsenseRaysEnd) {
    const BoxTree tree(boxes(300, 4));
    const double nan = std::nan("");
    for (const Ray& ray : {Ray{{nan, 0, 0}, {1, 0, 0}}, Ray{{0, 0, 0}, {nan, nan, nan}}, Ray{{0, 0, 0}, {0, 0, 0}},
                           Ray{{kInfinity, 0, 0}, {-1, 0, 0}}, Ray{{0, 0, 0}, {1, 0, 0}, nan, nan}})
        EXPECT_LE(met(tree, ray, ray.t_max).size(), 300u);
}

// Boxes one in another: centres agree, which is the worst for a split by centres.
TEST(BoxTree, NestedBoxes) {
    std::vector<Box> all;
    for (int n = 1; n <= 1000; ++n) all.push_back({glm::dvec3(-n), glm::dvec3(n)});
    const BoxTree tree(all);
    EXPECT_EQ(met(tree, {{-2000, 500.5, 0}, {1, 0, 0}}, kInfinity).size(), 500u);
}

}  // namespace
}  // namespace stratum::trace
