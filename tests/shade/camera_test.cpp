#include "shade/camera.h"

#include "io/error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>

namespace stratum {
namespace {

using shade::Camera;
using shade::CameraOptions;
using shade::View;

const march::Box kBoxes[] = {
    {{0, 0, 0}, {60, 31, 48}}, {{-200, 4, 0}, {200, 5, 0.3}}, {{1e5, 1e5, 10}, {1e5 + 2, 1e5 + 3, 250}}};

TEST(Camera, FitsTheBoxTightlyAndInTheMiddle) {
    for (const march::Box& box : kBoxes) {
        for (int v = 0; v < 7; ++v) {
            for (const auto& [w, h] : {std::pair{1280, 960}, std::pair{300, 900}}) {
                CameraOptions options;
                options.view = static_cast<View>(v);
                options.margin = 0.1;
                const Camera camera = Camera::make(options, box, w, h);
                glm::dvec2 low(1e9);
                glm::dvec2 high(-1e9);
                for (int i = 0; i < 8; ++i) {
                    const auto p = camera.project(
                        {i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y, i & 4 ? box.max.z : box.min.z});
                    ASSERT_TRUE(p);
                    low = glm::min(low, *p);
                    high = glm::max(high, *p);
                }
                const double left = low.x / w;
                const double right = 1.0 - high.x / w;
                const double above = low.y / h;
                const double below = 1.0 - high.y / h;
                EXPECT_NEAR(left, right, 1e-6);
                EXPECT_NEAR(above, below, 1e-6);
                EXPECT_NEAR(std::min(left, above), 0.1, 1e-6) << v;
            }
        }
    }
}

TEST(Camera, ProjectIsTheInverseOfRay) {
    const Camera camera({3, -40, 12}, {0, 0, 5}, {0, 0, 1}, 35.0, 640, 480);
    for (const glm::dvec2& pixel : {glm::dvec2(0, 0), glm::dvec2(320, 240), glm::dvec2(639.5, 17.25)}) {
        const march::Ray ray = camera.ray(pixel);
        EXPECT_NEAR(glm::length(ray.direction), 1.0, 1e-12);
        const auto p = camera.project(ray.origin + 7.0 * ray.direction);
        ASSERT_TRUE(p);
        EXPECT_NEAR(p->x, pixel.x, 1e-9);
        EXPECT_NEAR(p->y, pixel.y, 1e-9);
    }
    EXPECT_FALSE(camera.project({3, -80, 12}));
    // The field of view is the angle between the middles of the upper and lower edge.
    const double cosine = glm::dot(camera.ray({320, 0}).direction, camera.ray({320, 480}).direction);
    EXPECT_NEAR(std::acos(cosine), 35.0 * 3.14159265358979 / 180.0, 1e-9);
}

TEST(Camera, ViewsLookWhereTheirNamesSay) {
    const march::Box box{{-1, -1, -1}, {1, 1, 1}};
    const auto eye = [&](const char* name) {
        CameraOptions options;
        options.view = shade::parseView(name);
        return Camera::make(options, box, 100, 100).eye();
    };
    EXPECT_LT(eye("front").y, -1);
    EXPECT_GT(eye("back").y, 1);
    EXPECT_LT(eye("left").x, -1);
    EXPECT_GT(eye("right").x, 1);
    EXPECT_GT(eye("top").z, 1);
    EXPECT_LT(eye("bottom").z, -1);
    EXPECT_GT(eye("iso").x, 0);
    EXPECT_LT(eye("iso").y, 0);
    EXPECT_GT(eye("iso").z, 0);
    EXPECT_THROW(eye("side"), UsageError);
    CameraOptions top;
    top.view = View::top;
    EXPECT_NEAR(Camera::make(top, box, 100, 100).right().x, 1.0, 1e-12);
    EXPECT_NEAR(Camera::make(top, box, 100, 100).up().y, 1.0, 1e-12);
}

TEST(Camera, TakesAnEye) {
    const march::Box box{{0, 0, 0}, {2, 2, 2}};
    CameraOptions options;
    options.eye = glm::dvec3(1, 1, 20);
    const Camera camera = Camera::make(options, box, 100, 50);  // straight down: up falls back to +y
    EXPECT_NEAR(camera.forward().z, -1.0, 1e-12);
    EXPECT_NEAR(camera.up().y, 1.0, 1e-12);
}

TEST(Camera, RefusesNonsense) {
    const march::Box box{{0, 0, 0}, {2, 2, 2}};
    CameraOptions options;
    options.fov = 0.0;
    EXPECT_THROW(Camera::make(options, box, 10, 10), UsageError);
    options = {};
    options.look_at = glm::dvec3(0.0);
    EXPECT_THROW(Camera::make(options, box, 10, 10), UsageError);
    options.eye = glm::dvec3(0.0);
    EXPECT_THROW(Camera::make(options, box, 10, 10), UsageError);
    options.eye = glm::dvec3(5, 0, 0);
    options.up = glm::dvec3(-1, 0, 0);
    EXPECT_THROW(Camera::make(options, box, 10, 10), UsageError);
    options.up = glm::dvec3(std::nan(""), 0, 1);
    EXPECT_THROW(Camera::make(options, box, 10, 10), UsageError);
    // A box without size still gives a camera.
    EXPECT_TRUE(std::isfinite(Camera::make({}, {glm::dvec3(3.0), glm::dvec3(3.0)}, 10, 10).eye().x));
}

}  // namespace
}  // namespace stratum
