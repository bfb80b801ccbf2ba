#include "shade/scene/bed.h"

#include "base/error.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum {
namespace {

using shade::BedSurface;
using shade::BedTexture;

bool onLine(const BedTexture& grid, double x, double y) { return grid.at({x, y}).albedo.r > 0.1f; }

TEST(BedTexture, PaperIsPlain) {
    const BedTexture paper(BedSurface::paper);
    EXPECT_EQ(&paper.at({3.0, -1e9}), &paper.at({0.0, 0.0}));
    EXPECT_EQ(paper.normal({3.1, -17.0}), glm::dvec3(0, 0, 1));
    EXPECT_EQ(paper.mean(), paper.at({0.0, 0.0}).albedo);
    EXPECT_EQ(BedTexture(shade::Color(0.25f)).mean().g, 0.25f);
}

TEST(BedTexture, GridHasALineEveryTenMillimetres) {
    const BedTexture grid(BedSurface::grid);
    for (const double x : {-50.0, -10.1, 0.0, 20.14, 100.39}) EXPECT_TRUE(onLine(grid, x, 3.0)) << x;
    for (const double x : {-5.0, 20.16, 10.2, 100.41}) EXPECT_FALSE(onLine(grid, x, 3.0)) << x;
    EXPECT_TRUE(onLine(grid, 3.0, 30.0));
    EXPECT_EQ(grid.normal({20.0, 3.0}), glm::dvec3(0, 0, 1));
    const BedTexture metres(BedSurface::grid, 1000.0);
    EXPECT_TRUE(onLine(metres, 0.02014, 0.003));
    EXPECT_FALSE(onLine(metres, 0.02016, 0.003));
}

TEST(BedTexture, MeanIsThatOfManyPlaces) {
    const BedTexture grid(BedSurface::grid);
    double sum = 0.0;
    constexpr int kSide = 1000;
    for (int i = 0; i < kSide; ++i)
        for (int j = 0; j < kSide; ++j)
            sum += static_cast<double>(grid.at({50.0 * (i + 0.5) / kSide, 50.0 * (j + 0.5) / kSide}).albedo.r);
    EXPECT_NEAR(static_cast<double>(grid.mean().r), sum / (kSide * kSide), 1e-4);
}

TEST(BedTexture, PeiIsBumpyWithoutSeamsOrEnd) {
    const BedTexture pei(BedSurface::pei);
    glm::dvec3 sum(0.0);
    double steepest = 1.0;
    constexpr int kPlaces = 40000;
    for (int n = 0; n < kPlaces; ++n) {
        const glm::dvec2 p(0.0137 * n - 270.0, std::fmod(0.0911 * n, 61.0) - 30.0);
        const glm::dvec3 normal = pei.normal(p);
        ASSERT_NEAR(glm::length(normal), 1.0, 1e-12);
        ASSERT_NEAR(glm::length(pei.normal(p + glm::dvec2(1e-7, -1e-7)) - normal), 0.0, 1e-5);
        sum += normal;
        steepest = std::min(steepest, normal.z);
    }
    EXPECT_LT(steepest, 0.9);  // 26 degrees
    EXPECT_GT(steepest, 0.5);
    EXPECT_NEAR(sum.x / kPlaces, 0.0, 0.01);  // level on the whole
    EXPECT_NEAR(sum.y / kPlaces, 0.0, 0.01);
    for (const double far : {1e12, -1e30, 1e300}) EXPECT_GT(pei.normal({far, 1.0}).z, 0.0) << far;
}

/// Bumps have one height in each place: round any ring, what goes up comes down.
TEST(BedTexture, PeiHasTheNormalsOfASurface) {
    const BedTexture pei(BedSurface::pei, 2.0);  // in units of two millimetres
    constexpr int kSteps = 20000;
    for (int ring = 0; ring < 20; ++ring) {
        const glm::dvec2 center(7.3 * ring - 61.0, 3.1 * ring - 17.0);
        const double radius = 0.05 + 0.04 * ring;
        double height = 0.0;
        double climbed = 0.0;
        for (int n = 0; n < kSteps; ++n) {
            const double phi = 2.0 * std::numbers::pi * (n + 0.5) / kSteps;
            const glm::dvec2 out(std::cos(phi), std::sin(phi));
            const glm::dvec3 normal = pei.normal(center + radius * out);
            const double rise = glm::dot(glm::dvec2(normal) / -normal.z, glm::dvec2(-out.y, out.x));
            height += rise;
            climbed += std::abs(rise);
        }
        EXPECT_LT(std::abs(height), 2e-4 * climbed) << ring;
    }
}

}  // namespace
}  // namespace stratum
