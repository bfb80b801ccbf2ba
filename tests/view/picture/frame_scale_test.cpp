#include "view/picture/frame_scale.h"

#include <gtest/gtest.h>

namespace stratum::view {
namespace {

TEST(FrameScale, HoldsTheTimeOfAFrame) {
    FrameScale scale(0.05);
    constexpr double kCost = 1e-6;  // seconds a pixel
    for (int n = 0; n < 50; ++n) {
        const double side = scale.scale(1280, 720);
        const double pixels = 1280 * 720 * side * side;
        scale.took(pixels, kCost * pixels);
    }
    const double side = scale.scale(1280, 720);
    EXPECT_LE(1280 * 720 * side * side * kCost, 0.05);
    EXPECT_GT(1280 * 720 * side * side * kCost, 0.03);
}

TEST(FrameScale, StaysWithinItsBounds) {
    FrameScale scale(0.05);
    for (int n = 0; n < 50; ++n) scale.took(1000, 10);
    EXPECT_EQ(scale.scale(4000, 4000), FrameScale::kLeast);
    for (int n = 0; n < 500; ++n) scale.took(1e6, 0);
    EXPECT_EQ(scale.scale(640, 480), 1.0);
}

}  // namespace
}  // namespace stratum::view
