#include "shade/camera/pixel_size.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

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
        const trace::Box box{glm::min(a, b), glm::max(a, b)};
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

// By distance as well, wherever in the frame; and that is what corners of the frame see, not a bound far below it.
TEST(PixelSize, GrowsWithTheDistance) {
    const Camera camera({3, -100, 7}, {10, 20, -5}, {0, 0, 1}, 60, 320, 240);
    const trace::Box box{{-10, -20, -30}, {40, 50, 60}};
    const PixelSpread spread = pixelSpread(camera, box);
    EXPECT_EQ(spread.eye, camera.eye());
    EXPECT_EQ(spread.smallest, smallestPixel(camera, box));
    double farthest = 0;
    for (int corner = 0; corner < 8; ++corner)
        farthest = std::max(farthest, glm::length(glm::dvec3((corner & 1) != 0 ? 40 : -10, (corner & 2) != 0 ? 50 : -20,
                                                             (corner & 4) != 0 ? 60 : -30) -
                                                  camera.eye()));
    EXPECT_DOUBLE_EQ(spread.farthest, farthest);
    double tightest = 1e300;
    for (double x = 0; x <= 320; x += 20)
        for (double y = 0; y <= 240; y += 20) {
            const double distance = 40 + x;
            const glm::dvec3 p = camera.eye() + distance * camera.ray({x, y}).direction;
            const double pixel = glm::dot(p - camera.eye(), camera.forward()) * camera.pixelSize();
            EXPECT_LE(spread.per_distance * distance, pixel * (1 + 1e-12));
            tightest = std::min(tightest, pixel / (spread.per_distance * distance));
        }
    EXPECT_NEAR(tightest, 1, 1e-9);
    EXPECT_EQ(pixelSpread(camera, box, 4).farthest, 0.0);
}

}  // namespace
}  // namespace stratum::shade
