#include "shade/camera/camera.h"

#include "base/error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <vector>

namespace stratum {
namespace {

using shade::Camera;
using shade::CameraOptions;
using shade::View;

const trace::Box kBoxes[] = {
    {{0, 0, 0}, {60, 31, 48}}, {{-200, 4, 0}, {200, 5, 0.3}}, {{1e5, 1e5, 10}, {1e5 + 2, 1e5 + 3, 250}}};

TEST(Camera, FitsTheBoxTightlyAndInTheMiddle) {
    for (const trace::Box& box : kBoxes) {
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

// An octahedron fills as much of the frame as its box would, though the corners of the box are far from it.
TEST(Camera, FitsAnOutline) {
    const trace::Box box{{0, 0, 0}, {60, 40, 50}};
    const std::vector<glm::dvec3> outline{{0, 20, 25},  {60, 20, 25}, {30, 0, 25},
                                          {30, 40, 25}, {30, 20, 0},  {30, 20, 50}};
    for (int v = 0; v < 7; ++v)
        for (const bool all_around : {false, true}) {
            CameraOptions options;
            options.view = static_cast<View>(v);
            options.all_around = all_around;
            const Camera camera = Camera::make(options, box, 800, 600, outline);
            double least = 1.0;  // share of the frame between a point and the edge
            for (const glm::dvec3& point : outline) {
                const auto p = camera.project(point);
                ASSERT_TRUE(p);
                least = std::min({least, p->x / 800, 1.0 - p->x / 800, p->y / 600, 1.0 - p->y / 600});
            }
            if (all_around)
                EXPECT_GE(least, options.margin - 1e-6);
            else
                EXPECT_NEAR(least, options.margin, 1e-6) << v;
        }
}

TEST(Camera, ProjectIsTheInverseOfRay) {
    const Camera camera({3, -40, 12}, {0, 0, 5}, {0, 0, 1}, 35.0, 640, 480);
    for (const glm::dvec2& pixel : {glm::dvec2(0, 0), glm::dvec2(320, 240), glm::dvec2(639.5, 17.25)}) {
        const trace::Ray ray = camera.ray(pixel);
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
    const trace::Box box{{-1, -1, -1}, {1, 1, 1}};
    const auto eye = [&](const char* name) {
        CameraOptions options;
        options.view = valueOf(shade::kViews, name).value();
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
    CameraOptions top;
    top.view = View::top;
    EXPECT_NEAR(Camera::make(top, box, 100, 100).right().x, 1.0, 1e-12);
    EXPECT_NEAR(Camera::make(top, box, 100, 100).up().y, 1.0, 1e-12);
}

TEST(Camera, TakesAnEye) {
    const trace::Box box{{0, 0, 0}, {2, 2, 2}};
    CameraOptions options;
    options.eye = glm::dvec3(1, 1, 20);
    const Camera camera = Camera::make(options, box, 100, 50);  // straight down: up falls back to +y
    EXPECT_NEAR(camera.forward().z, -1.0, 1e-12);
    EXPECT_NEAR(camera.up().y, 1.0, 1e-12);
}

TEST(Camera, RefusesNonsense) {
    const trace::Box box{{0, 0, 0}, {2, 2, 2}};
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

TEST(Camera, ALensIsSharpWhereItIsFocused) {
    const trace::Box box{{-10, -10, 0}, {10, 10, 20}};
    CameraOptions options;
    options.eye = glm::dvec3(0, -100, 10);
    EXPECT_FALSE(Camera::make(options, box, 400, 300).hasLens());
    options.aperture = 4;
    const Camera camera = Camera::make(options, box, 400, 300);
    ASSERT_TRUE(camera.hasLens());
    const glm::dvec2 pixel(137.5, 210.25);
    const trace::Ray pinhole = camera.ray(pixel);
    // All rays of a pixel meet where the pinhole's is at the depth of the box' middle.
    const glm::dvec3 meeting =
        pinhole.origin + pinhole.direction * (100 / glm::dot(pinhole.direction, camera.forward()));
    double widest = 0;
    for (int a = 0; a < 8; ++a)
        for (int b = 0; b < 8; ++b) {
            const trace::Ray ray = camera.ray(pixel, {(a + 0.5f) / 8, (b + 0.5f) / 8});
            EXPECT_NEAR(glm::length(ray.direction), 1, 1e-12);
            EXPECT_NEAR(glm::dot(ray.origin - camera.eye(), camera.forward()), 0, 1e-12);
            widest = std::max(widest, glm::length(ray.origin - camera.eye()));
            const double along = glm::dot(meeting - ray.origin, ray.direction);
            EXPECT_NEAR(glm::length(ray.origin + along * ray.direction - meeting), 0, 1e-9);
        }
    EXPECT_GT(widest, 1.9);
    EXPECT_LE(widest, 2);
    options.focus_point = glm::dvec3(3, -50, 2);
    const Camera near = Camera::make(options, box, 400, 300);
    const trace::Ray ray = near.ray(*near.project(*options.focus_point), {0.7f, 0.3f});
    const double along = glm::dot(*options.focus_point - ray.origin, ray.direction);
    EXPECT_NEAR(glm::length(ray.origin + along * ray.direction - *options.focus_point), 0, 1e-9);
    // f/2.8 at 28 degrees is a lens of 12 mm / tan 14 degrees / 2.8.
    options = {};
    options.f_number = 2.8;
    const Camera photo = Camera::make(options, box, 400, 300);
    const trace::Ray edge = photo.ray({0, 0}, {0.9999999f, 0.0f});
    const double radius = 0.5 * 12 / std::tan(14 * std::acos(-1.0) / 180) / 2.8;
    EXPECT_NEAR(glm::length(edge.origin - photo.eye()), radius, 1e-4);
    // The same thing in metres has the same picture.
    options.mm_per_unit = 1000;
    const Camera metres = Camera::make(options, {1e-3 * box.min, 1e-3 * box.max}, 400, 300);
    EXPECT_NEAR(glm::length(metres.ray({0, 0}, {0.9999999f, 0.0f}).origin - metres.eye()), 1e-3 * radius, 1e-7);
}

TEST(Camera, ZoomMagnifiesFromTheSamePlace) {
    const trace::Box box{{-10, -10, 0}, {10, 10, 20}};
    CameraOptions options;
    const Camera plain = Camera::make(options, box, 400, 300);
    options.zoom = 2;
    const Camera zoomed = Camera::make(options, box, 400, 300);
    EXPECT_EQ(plain.eye(), zoomed.eye());
    const glm::dvec2 middle(200, 150);
    for (const glm::dvec3 place : {glm::dvec3(10, 3, 20), glm::dvec3(-4, 8, 1)}) {
        const glm::dvec2 before = *plain.project(place) - middle;
        const glm::dvec2 after = *zoomed.project(place) - middle;
        EXPECT_NEAR(after.x, 2 * before.x, 1e-9);
        EXPECT_NEAR(after.y, 2 * before.y, 1e-9);
    }
    options.zoom = 0;
    EXPECT_THROW(Camera::make(options, box, 400, 300), UsageError);
}

TEST(Camera, RefusesLensesThatAreNone) {
    const trace::Box box{{-10, -10, 0}, {10, 10, 20}};
    const auto refused = [&](const CameraOptions& options) {
        EXPECT_THROW(Camera::make(options, box, 10, 10), UsageError);
    };
    CameraOptions options;
    options.aperture = -1;
    refused(options);
    options = {};
    options.focus_distance = 10;
    refused(options);  // without a lens
    options.f_number = 4;
    EXPECT_NO_THROW(Camera::make(options, box, 10, 10));
    options.aperture = 4;
    refused(options);
    options.aperture = 0;
    options.focus_distance = -3;
    refused(options);
    options.focus_distance.reset();
    options.eye = glm::dvec3(0, -100, 10);
    options.focus_point = glm::dvec3(0, -200, 10);  // behind
    refused(options);
    options.focus_point = glm::dvec3(std::nan(""), 0, 0);
    refused(options);
}

TEST(Camera, TurnsAroundAThing) {
    const trace::Box box{{-10, -20, 0}, {30, 10, 20}};
    CameraOptions options;
    options.all_around = true;
    const Camera first = Camera::make(options, box, 400, 300);
    const glm::dvec3 middle(10, -5, 10);
    for (int turn = 0; turn < 24; ++turn) {
        const Camera camera = first.turned(15.0 * turn, middle);
        EXPECT_NEAR(glm::length(camera.eye() - middle), glm::length(first.eye() - middle), 1e-9);
        EXPECT_NEAR(camera.eye().z, first.eye().z, 1e-12);
        EXPECT_NEAR(glm::dot(camera.right(), camera.forward()), 0, 1e-12);
        // Everything stays in the picture.
        for (int corner = 0; corner < 8; ++corner) {
            const auto seen = camera.project(
                {(corner & 1) != 0 ? 30 : -10, (corner & 2) != 0 ? 10 : -20, (corner & 4) != 0 ? 20 : 0});
            ASSERT_TRUE(seen);
            EXPECT_GT(seen->x, 0);
            EXPECT_LT(seen->x, 400);
            EXPECT_GT(seen->y, 0);
            EXPECT_LT(seen->y, 300);
        }
    }
    EXPECT_NEAR(first.turned(90, middle).eye().x, middle.x - (first.eye().y - middle.y), 1e-9);
}

}  // namespace
}  // namespace stratum
