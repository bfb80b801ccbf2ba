#include "voxelize/beads/layer_stack.h"

#include "toolpaths.h"

#include <gtest/gtest.h>

namespace stratum::voxelize {
namespace {

using test::addBead;
using test::allBeads;

std::vector<std::uint32_t> beadsOf(const LayerStack& stack, std::size_t layer) {
    const Layer& l = stack.layers[layer];
    return {stack.beads.data() + l.first, stack.beads.data() + l.last};
}

TEST(LayerStack, GroupsByPlaneAndHeight) {
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 0.2, 9, 0, 0.2, 0.5, 0.2);
    addBead(toolpath, 0, 1, 0.2, 9, 1, 0.2, 0.4, 0.2);
    addBead(toolpath, 0, 0, 0.4, 9, 0, 0.4, 0.5, 0.2);
    addBead(toolpath, 0, 2, 0.4, 9, 2, 0.4, 0.5, 0.4);   // same nozzle height, twice as thick
    addBead(toolpath, 0, 3, 0.4, 9, 3, 0.5, 0.5, 0.2);   // sloped
    addBead(toolpath, 0, 4, 0.4, 9, 4, 0.4, 0.15, 0.2);  // round
    const LayerStack stack = stackLayers(toolpath, allBeads(toolpath));
    ASSERT_EQ(stack.layers.size(), 3U);
    EXPECT_EQ(beadsOf(stack, 0), (std::vector<std::uint32_t>{0, 1}));
    EXPECT_DOUBLE_EQ(stack.layers[0].center_z, 0.1);
    EXPECT_DOUBLE_EQ(stack.layers[0].radius, 0.1);
    EXPECT_EQ(beadsOf(stack, 1), (std::vector<std::uint32_t>{3}));  // centre 0.2
    EXPECT_EQ(beadsOf(stack, 2), (std::vector<std::uint32_t>{2}));  // centre 0.3
    EXPECT_EQ(std::vector(stack.direct().begin(), stack.direct().end()), (std::vector<std::uint32_t>{4, 5}));
    EXPECT_EQ(stack.layer, (std::vector<std::uint32_t>{0, 0, 1, 2, 3, 3}));
    ASSERT_EQ(stack.welds.size(), 1U);  // 0.2 rests on 0.2; the thick one reaches down to the bed
    EXPECT_EQ(stack.welds[0].lower, 0U);
    EXPECT_EQ(stack.welds[0].upper, 2U);
}

TEST(LayerStack, RoundedZAndRelativeMovesStillMakeOneLayerAndWeld) {
    gcode::Toolpath toolpath;
    double z = 0;
    for (int n = 0; n < 3; ++n) z += 0.1;  // 0.30000000000000004
    addBead(toolpath, 0, 0, z, 9, 0, z, 0.5, 0.1);
    addBead(toolpath, 0, 1, 0.3, 9, 1, 0.3, 0.5, 0.1);
    addBead(toolpath, 0, 0, 0.4005, 9, 0, 0.4005, 0.5, 0.1);  // 0.5 % of a layer above
    addBead(toolpath, 0, 0, 0.51, 9, 0, 0.51, 0.5, 0.1);      // 9.5 %: a real gap
    const LayerStack stack = stackLayers(toolpath, allBeads(toolpath));
    ASSERT_EQ(stack.layers.size(), 3U);
    EXPECT_EQ(beadsOf(stack, 0).size(), 2U);
    ASSERT_EQ(stack.welds.size(), 1U);
    EXPECT_EQ(stack.welds[0].upper, 1U);
}

TEST(LayerStack, TakesOnlyTheSelection) {
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 0.2, 9, 0, 0.2, 0.5, 0.2);
    addBead(toolpath, 0, 0, 0.4, 9, 0, 0.4, 0.5, 0.2);
    const std::vector<std::uint32_t> only{1};
    const LayerStack stack = stackLayers(toolpath, only);
    ASSERT_EQ(stack.layers.size(), 1U);
    EXPECT_EQ(beadsOf(stack, 0), only);
    EXPECT_TRUE(stack.welds.empty());
}

}  // namespace
}  // namespace stratum::voxelize
