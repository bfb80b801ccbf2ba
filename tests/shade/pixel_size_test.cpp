#include "shade/pixel_size.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace stratum::shade {
namespace {

TEST(PixelSize, IsThatOfTheNearestFace) {
    const Camera camera({0, -100, 0}, {0, 0, 0}, {0, 0, 1}, 90, 200, 100);
    // 80 before the eye the frame is 160 high.
    EXPECT_NEAR(smallestPixel(camera, {{-10, -20, -10}, {10, 20, 10}}), 1.6, 1e-12);
}

TEST(PixelSize, IsNothingInTheBox) {
    const Camera camera({0, -100, 0}, {0, 0, 0}, {0, 0, 1}, 30, 200, 100);
    EXPECT_EQ(smallestPixel(camera, {{-200, -200, -200}, {200, 200, 200}}), 0.0);
}

// Every point of the box that is seen spans at least that, also of boxes that reach beside and behind the camera.
TEST(PixelSize, IsNeverMoreThanAPointShows) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> where(-50, 50);
    int seen = 0;
    for (int n = 0; n < 200; ++n) {
        const Camera camera({where(random), where(random), where(random)}, {where(random), 0, where(random)}, {0, 0, 1},
                            50, 320, 240);
        const glm::dvec3 a(where(random), where(random), where(random));
        const glm::dvec3 b(where(random), where(random), where(random));
        const march::Box box{glm::min(a, b), glm::max(a, b)};
        const double smallest = smallestPixel(camera, box);
        std::uniform_real_distribution<double> part(0, 1);
        for (int k = 0; k < 200; ++k) {
            const glm::dvec3 p = box.min + glm::dvec3(part(random), part(random), part(random)) * (box.max - box.min);
            const auto pixel = camera.project(p);
            if (!pixel || pixel->x < 0 || pixel->x > 320 || pixel->y < 0 || pixel->y > 240) continue;
            ++seen;
            const glm::dvec3 right = p + smallest * camera.right();
            ASSERT_LE(camera.project(right)->x - pixel->x, 1 + 1e-9);
        }
    }
    EXPECT_GT(seen, 1000);
}

}  // namespace
}  // namespace stratum::shade
