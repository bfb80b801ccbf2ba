#include "compare/comparison.h"

#include "shapes.h"

#include "base/error.h"

#include <gtest/gtest.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::compare {
namespace {

constexpr double kVoxel = 0.1;

openvdb::FloatGrid::Ptr sphere(double radius, const openvdb::Vec3d& at) {
    return openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(static_cast<float>(radius), openvdb::Vec3f(at),
                                                                    static_cast<float>(kVoxel));
}

CompareOptions onTheBed() {
    CompareOptions options;
    options.placement = ModelPlacement::bed;
    options.samples = 20000;
    return options;
}

// A sphere that is 0.15 mm too large: all deviations are known, both ways.
TEST(Comparison, OfASphereThatIsTooLarge) {
    openvdb::initialize();
    const ClosedModel model(test::ellipsoidModel({5, 5, 5}, 200), "sphere");
    const Comparison found = compareToModel(*sphere(5.15, {0, 0, 0}), model, onTheBed());
    EXPECT_FALSE(found.fit);
    for (const Deviations& way : {found.print_to_model.all, found.model_to_surface.all, found.print_to_model.walls,
                                  found.print_to_model.tops, found.model_to_surface.bottoms}) {
        EXPECT_NEAR(way.mean, 0.15, 0.25 * kVoxel);
        EXPECT_NEAR(way.rms, 0.15, 0.25 * kVoxel);
        EXPECT_NEAR(way.within_95, 0.15, 0.25 * kVoxel);
        EXPECT_NEAR(way.least.mm, 0.15, 0.25 * kVoxel);
        EXPECT_NEAR(way.most.mm, 0.15, 0.25 * kVoxel);
    }
    // Caps of 45 degrees have the share 1 - cos 45 degrees of a hemisphere.
    EXPECT_NEAR(static_cast<double>(found.model_to_surface.tops.samples) / 20000, 0.5 * (1 - std::sqrt(0.5)), 0.005);
    EXPECT_NEAR(found.print_mm2, 4 * std::numbers::pi * 5.15 * 5.15, 1);
}

// Moved by 0.2 mm along x: deviations are 0.2 times the cosine, extremes lie on the axis.
TEST(Comparison, TellsWhereTheExtremesAre) {
    openvdb::initialize();
    const ClosedModel model(test::ellipsoidModel({5, 5, 5}, 200), "sphere");
    const Comparison found = compareToModel(*sphere(5, {0.2, 0, 0}), model, onTheBed());
    for (const Deviations& way : {found.print_to_model.all, found.model_to_surface.all}) {
        EXPECT_NEAR(way.most.mm, 0.2, 0.25 * kVoxel);
        EXPECT_NEAR(way.least.mm, -0.2, 0.25 * kVoxel);
        EXPECT_NEAR(way.rms, 0.2 / std::sqrt(3), 0.01);
        EXPECT_NEAR(way.mean, 0, 0.01);
        EXPECT_GT(way.most.place.x, 4.5);
        EXPECT_LT(way.least.place.x, -4.5);
    }
    CompareOptions fit = onTheBed();
    fit.placement = ModelPlacement::fit;
    const Comparison placed = compareToModel(*sphere(5, {0.2, 0, 0}), model, fit);
    ASSERT_TRUE(placed.fit);
    EXPECT_NEAR(placed.model_to_print({0, 0, 0}).x, 0.2, 0.02);
    EXPECT_LT(placed.print_to_model.all.rms, 0.01);
}

TEST(Comparison, DeviationsOfVoxelsAreThoseOfTheirSurface) {
    openvdb::initialize();
    const ClosedModel model(test::ellipsoidModel({5, 5, 5}, 200), "sphere");
    const auto surface = sphere(5.15, {0, 0, 0});
    const Comparison found = compareToModel(*surface, model, onTheBed());
    EXPECT_NEAR(shownDeviation(found), 0.2, 1e-12);
    const auto grid = deviationGrid(*surface, surface->transform(), model, found);
    EXPECT_EQ(grid->metaValue<openvdb::Vec2d>("range"), openvdb::Vec2d(-0.2, 0.2));
    EXPECT_EQ(grid->activeVoxelCount(), surface->activeVoxelCount());
    EXPECT_EQ(grid->getName(), "deviation");
    for (auto value = grid->cbeginValueOn(); value; ++value)
        ASSERT_NEAR(static_cast<double>(*value), 0.15, 0.25 * kVoxel) << value.getCoord();
}

// As on a belt: the voxels lean, and so do the directions to their surface.
TEST(Comparison, DeviationsOfLeaningVoxelsAreThoseOfTheirSurface) {
    openvdb::initialize();
    const ClosedModel model(test::ellipsoidModel({5, 5, 5}, 200), "sphere");
    const auto surface = sphere(5.15, {0, 0, 0});
    surface->transform().postRotate(std::acos(-1.0) / 4, openvdb::math::X_AXIS);
    const Comparison found = compareToModel(*surface, model, onTheBed());
    EXPECT_NEAR(found.print_to_model.all.mean, 0.15, 0.01);
    const auto grid = deviationGrid(*surface, surface->transform(), model, found);
    for (auto value = grid->cbeginValueOn(); value; ++value)
        ASSERT_NEAR(static_cast<double>(*value), 0.15, 0.25 * kVoxel) << value.getCoord();
}

TEST(Comparison, DoesNotDependOnTheNumberOfThreads) {
    openvdb::initialize();
    const ClosedModel model(test::ellipsoidModel({5, 5, 5}, 50), "sphere");
    const auto with = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        CompareOptions options;
        options.samples = 5000;
        return compareToModel(*sphere(5, {0.2, 0.1, 0}), model, options);
    };
    const Comparison one = with(1);
    const Comparison many = with(4);
    EXPECT_EQ(one.print_to_model.all.rms, many.print_to_model.all.rms);
    EXPECT_EQ(one.model_to_surface.all.mean, many.model_to_surface.all.mean);
    EXPECT_EQ(one.fit->residual, many.fit->residual);
}

TEST(Comparison, NothingIsRefused) {
    const ClosedModel model(test::ellipsoidModel({5, 5, 5}, 10), "sphere");
    EXPECT_THROW(compareToModel(*openvdb::FloatGrid::create(0.3F), model, onTheBed()), UsageError);
}

}  // namespace
}  // namespace stratum::compare
