#include "march/brick/brick_intersector.h"

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

namespace stratum::march {
namespace {

constexpr float kFlatVoxel = 0.1F;  // mm
constexpr int kEdge = 64;           // voxels

// A plate whose top lies on the voxel plane z = 0. As in prints, the samples there are zeros but for the rounding of
// floats: some are inside.
openvdb::FloatGrid::Ptr plate() {
    auto grid = openvdb::FloatGrid::create(3 * kFlatVoxel);
    grid->setTransform(openvdb::math::Transform::createLinearTransform(static_cast<double>(kFlatVoxel)));
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    grid->setName("surface");
    std::mt19937 random(3);
    std::uniform_real_distribution<float> rounding(-1.5e-8F, 1.5e-8F);
    auto accessor = grid->getAccessor();
    for (int x = 0; x < kEdge; ++x)
        for (int y = 0; y < kEdge; ++y)
            for (int z = -3; z <= 3; ++z)
                accessor.setValue({x, y, z}, z == 0 ? rounding(random) : kFlatVoxel * static_cast<float>(z));
    return grid;
}

struct ComparedRays {
    int hits = 0, extra = 0, missed = 0;
    double farthest = 0;  // mm between the hits of both
};

ComparedRays compare(const std::vector<trace::Ray>& rays) {
    openvdb::initialize();
    const auto grid = plate();
    const auto floats = makeBrickIntersector(*grid, BrickValues::Float32);
    const auto quanta = makeBrickIntersector(*grid, BrickValues::Int16);
    std::vector<trace::Hit> expected(rays.size());
    std::vector<trace::Hit> found(rays.size());
    floats->makeTracer()->intersectStream(rays, expected);
    quanta->makeTracer()->intersectStream(rays, found);
    ComparedRays result;
    for (std::size_t n = 0; n < rays.size(); ++n) {
        const bool hit = std::isfinite(expected[n].t);
        result.hits += hit ? 1 : 0;
        result.extra += !hit && std::isfinite(found[n].t) ? 1 : 0;
        result.missed += hit && !std::isfinite(found[n].t) ? 1 : 0;
        if (hit && std::isfinite(found[n].t))
            result.farthest = std::max(result.farthest, std::abs(found[n].t - expected[n].t));
    }
    return result;
}

// Close above the plate and nearly along it: a quantum is 9e-6 mm here, and samples of a whole one below zero would
// stop rays that pass.
TEST(FlatRays, SixteenBitsAnswerAsFloatsDoAlongFlats) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<trace::Ray> passing;
    std::vector<trace::Ray> falling;
    for (int n = 0; n < 4096; ++n) {
        trace::Ray ray;
        ray.origin = {0.5, 0.5 + 5.0 * unit(random), std::pow(10.0, -7 + 3 * unit(random))};
        ray.direction = glm::normalize(glm::dvec3(1, 1e-3 * (unit(random) - 0.5), 0));
        passing.push_back(ray);
        // Meets the plate 1 to 5 mm on, under slopes from 1e-5 to 1e-2.
        const double slope = std::pow(10.0, -5 + 3 * unit(random));
        ray.origin.z = slope * (1 + 4 * unit(random));
        ray.direction = glm::normalize(glm::dvec3(1, 0, -slope));
        falling.push_back(ray);
    }
    const ComparedRays past = compare(passing);
    EXPECT_EQ(past.hits, 0);
    EXPECT_EQ(past.extra, 0);
    const ComparedRays down = compare(falling);
    EXPECT_EQ(down.hits, 4096);
    EXPECT_EQ(down.missed, 0);
    // 3e-8 mm of height at a slope of 1e-5.
    EXPECT_LT(down.farthest, 4e-3);
}

}  // namespace
}  // namespace stratum::march
