#include "voxelize/beads/lattice.h"

#include "base/error.h"
#include "toolpaths.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace stratum::voxelize {
namespace {

using test::addBead;
using test::allBeads;

Lattice choose(const gcode::Toolpath& toolpath, const LatticeRequest& request) {
    const auto beads = allBeads(toolpath);
    return chooseLattice(toolpath, beads, boundsOf(toolpath, beads), request);
}

LatticeRequest voxel(double mm) {
    LatticeRequest request;
    request.voxel_size = mm;
    return request;
}

gcode::Toolpath stack(double first, double height, int layers) {
    gcode::Toolpath toolpath;
    for (int n = 0; n < layers; ++n)
        addBead(toolpath, 0, 0, first + n * height, 50, 0, first + n * height, 0.5, n == 0 ? first : height);
    return toolpath;
}

TEST(Lattice, VoxelsPerLayerDividesTheLayerHeight) {
    LatticeRequest request;
    request.voxels_per_layer = 4;
    const Lattice lattice = choose(stack(0.2, 0.2, 10), request);
    EXPECT_DOUBLE_EQ(lattice.voxel_size, 0.05);
    EXPECT_DOUBLE_EQ(lattice.origin_z, 0);
    EXPECT_DOUBLE_EQ(lattice.aligned_share, 1);
}

TEST(Lattice, OriginFollowsTheMajorityPlane) {
    // A first layer of 0.35 mm under layers of 0.2 mm: planes lie at 0.35 + 0.2 n.
    const Lattice lattice = choose(stack(0.35, 0.2, 20), voxel(0.1));
    EXPECT_NEAR(lattice.origin_z, 0.05, 1e-12);
    EXPECT_NEAR(lattice.aligned_share, 19.0 / 20, 1e-9);
}

// A hundred layers of 5/32 mm: a height rounded to micrometres would miss the upper ones.
TEST(Lattice, HeightsNeedNotBeWholeMicrometres) {
    LatticeRequest request;
    request.voxels_per_layer = 4;
    for (const double height : {0.15625, 0.1875, 0.1778}) {
        const Lattice lattice = choose(stack(height, height, 100), request);
        EXPECT_NEAR(lattice.layer_height, height, 1e-7);
        EXPECT_DOUBLE_EQ(lattice.aligned_share, 1) << height;
    }
}

TEST(Lattice, SaysWhenNothingAligns) { EXPECT_LT(choose(stack(0.2, 0.2, 20), voxel(0.07)).aligned_share, 0.2); }

TEST(Lattice, ChoosesByItselfBetweenTwoAndFourVoxelsALayer) {
    const Lattice small = choose(stack(0.2, 0.2, 10), {});
    EXPECT_DOUBLE_EQ(small.voxel_size, 0.05);
    const Lattice large = choose(stack(0.2, 0.2, 200000), {});
    EXPECT_DOUBLE_EQ(large.voxel_size, 0.1);
}

TEST(Lattice, ShortPixelsHaveMoreVoxels) {
    const auto sizeAt = [](double pixel, int layers = 10) {
        LatticeRequest request;
        request.pixel = pixel;
        return choose(stack(0.2, 0.2, layers), request).voxel_size;
    };
    EXPECT_DOUBLE_EQ(sizeAt(0.025), 0.05) << "a voxel spans two pixels";
    EXPECT_DOUBLE_EQ(sizeAt(0.021), 0.04) << "no more than two";
    EXPECT_DOUBLE_EQ(sizeAt(0.001), 0.025) << "eight a layer at most";
    EXPECT_DOUBLE_EQ(sizeAt(0.001, 200000), 0.1) << "a print too large for four keeps fewer";
    LatticeRequest asked = voxel(0.1);
    asked.pixel = 0.001;
    EXPECT_DOUBLE_EQ(choose(stack(0.2, 0.2, 10), asked).voxel_size, 0.1);
}

TEST(Lattice, ChoosesWhatTheMemoryHolds) {
    const auto print = stack(0.2, 0.2, 2000);
    LatticeRequest request;
    request.memory = std::size_t{1} << 40;
    const Lattice plenty = choose(print, request);
    EXPECT_DOUBLE_EQ(plenty.voxel_size, 0.05);
    EXPECT_EQ(plenty.reason.find("free"), std::string::npos) << plenty.reason;
    request.memory = std::size_t{1} << 20;
    const Lattice scarce = choose(print, request);
    EXPECT_DOUBLE_EQ(scarce.voxel_size, 0.1);
    EXPECT_NE(scarce.reason.find("3 would take about"), std::string::npos) << scarce.reason;
}

TEST(Lattice, RefusesNonsense) {
    const auto toolpath = stack(0.2, 0.2, 3);
    for (const double size : {0.0, -1.0, 1e-9, 60.0, std::numeric_limits<double>::infinity(), std::nan("")})
        EXPECT_THROW(choose(toolpath, voxel(size)), UsageError) << size;
    LatticeRequest request;
    request.voxels_per_layer = 0;
    EXPECT_THROW(choose(toolpath, request), UsageError);
    request.voxels_per_layer = 65;
    EXPECT_THROW(choose(toolpath, request), UsageError);
    request = voxel(0.1);
    request.half_width = 0.5;
    EXPECT_THROW(choose(toolpath, request), UsageError);
}

}  // namespace
}  // namespace stratum::voxelize
