#include "assemble/hot_end.h"

#include "assemble/ready_scene.h"
#include "prints.h"
#include "trace/sdf.h"
#include "trace/sdf_intersector.h"

#include <gtest/gtest.h>

namespace stratum::assemble {
namespace {

TEST(HotEnd, StandsWithItsTipOnAPlace) {
    const std::shared_ptr<const trace::Intersector> ball = trace::makeSdfIntersector(trace::sdfSphere({0, 0, 0}, 5));
    const glm::dvec3 tip(3, 4, 8);
    const auto both = withHotEnd(ball, tip, makeHotEndParts(HotEndShape::slender));
    const auto tracer = both->makeTracer();
    trace::Ray ray;
    ray.origin = {3, 4, 7};
    trace::Hit hit;
    ASSERT_TRUE(tracer->intersect(ray, hit));  // up to the flat tip
    EXPECT_DOUBLE_EQ(hit.position.z, 8.0);
    EXPECT_EQ(hit.object, 1u);
    ray.origin.x += 0.51;  // past it, on the cone
    ASSERT_TRUE(tracer->intersect(ray, hit));
    EXPECT_NEAR(hit.position.z, 8.0 + 0.01 * 3 / 2.5, 1e-9);
    // From all sides it is slender near the tip, and each part has an object number of its own.
    for (const auto& [height, object] : {std::pair{1.5, 1u}, {4.5, 2u}, {10.0, 3u}, {15.5, 4u}, {22.0, 5u}}) {
        ray.origin = tip + glm::dvec3(0, -50, height);
        ray.direction = {0, 1, 0};
        ASSERT_TRUE(tracer->intersect(ray, hit));
        EXPECT_EQ(hit.object, object);
    }
    // The print is object 0, as it is alone.
    ray.origin = {0, 0, -50};
    ray.direction = {0, 0, 1};
    ASSERT_TRUE(tracer->intersect(ray, hit));
    EXPECT_EQ(hit.object, 0u);
}

TEST(HotEnd, IsOfMetalAndLeavesThePrintItsMaterial) {
    const TracedObjects objects =
        readTracedObjects({test::objectOf(test::sourceDir() / "data/gcode/tile.gcode")}, test::coarseTracing());
    shade::SceneDescription scene = makeStage(objects, {}).scene;
    ASSERT_TRUE(scene.objects.empty());
    const HotEnd hot_end(objects, scene, {HotEndKind::metal});
    ASSERT_EQ(scene.objects.size(), 6u);
    EXPECT_EQ(scene.objects.front().only().brdf, scene.material);
    const shade::Color brass = scene.objects[1].only().albedo;
    EXPECT_GT(brass.r, brass.b);
}

TEST(HotEnd, IsSmallerAboveASmallPart) {
    const std::shared_ptr<const trace::Intersector> ball = trace::makeSdfIntersector(trace::sdfSphere({0, 0, 0}, 5));
    const auto parts = makeHotEndParts(HotEndShape::slender);
    const double top = withHotEnd(ball, {0, 0, 5}, parts)->bounds().max.z;
    EXPECT_NEAR(withHotEnd(ball, {0, 0, 5}, parts, 0.25)->bounds().max.z - 5, 0.25 * (top - 5), 1e-9);
    EXPECT_NEAR(top, 32, 1e-9);
}

// As the gantry of a belt printer does: its axis is the layers' normal.
TEST(HotEnd, LeansWithTheLayers) {
    const std::shared_ptr<const trace::Intersector> ball = trace::makeSdfIntersector(trace::sdfSphere({0, 0, -9}, 1));
    const auto both = withHotEnd(ball, {0, 0, 0}, makeHotEndParts(HotEndShape::slender), 1.0, 45.0);
    const auto tracer = both->makeTracer();
    const double half = std::sqrt(0.5);
    trace::Hit hit;
    // Down along the axis, which leads back along the belt as it rises.
    ASSERT_TRUE(tracer->intersect({glm::dvec3(0, -half, half) * 100.0, {0, half, -half}}, hit));
    EXPECT_NEAR(hit.t, 100 - 27, 1e-6);
    EXPECT_FALSE(tracer->intersect({{0, 0, 100}, {0, 0, -1}, 0.0, 80.0}, hit));
}

// Lengths of public models of the maker's drawings: in all, from the tip to the lowest fin, across the fins, and of the
// block.
TEST(HotEnd, HasTheOutlineOfItsMaker) {
    const std::shared_ptr<const trace::Intersector> ball = trace::makeSdfIntersector(trace::sdfSphere({0, 0, -5}, 5));
    struct Outline {
        HotEndShape shape;
        double height, block, sink;  // mm
    };
    for (const auto& [shape, height, block, sink] :
         {Outline{HotEndShape::v6, 62.3, 23.0, 19.6}, Outline{HotEndShape::volcano, 70.8, 11.5, 28.1}}) {
        const auto both = withHotEnd(ball, {0, 0, 0}, makeHotEndParts(shape));
        EXPECT_NEAR(both->bounds().max.z, height, 1e-9);
        const auto tracer = both->makeTracer();
        const auto width = [&](double z) {
            double across = 0.0;
            for (const double side : {-1.0, 1.0}) {
                trace::Ray ray;
                ray.origin = {50 * side, 0, z};
                ray.direction = {-side, 0, 0};
                trace::Hit hit;
                if (!tracer->intersect(ray, hit)) return 0.0;
                across += side * hit.position.x;
            }
            return across;
        };
        EXPECT_NEAR(width(12), block, 1e-9);
        EXPECT_NEAR(width(sink + 0.5), 22.3, 1e-9);
        EXPECT_NEAR(width(sink - 0.5), 2.96, 1e-9);  // the heat break
        EXPECT_NEAR(width(sink + 1.75), 9.0, 1e-9);  // between two fins
        EXPECT_NEAR(width(sink + 25.5), 22.0, 1e-9);
    }
}

TEST(HotEnd, AClearOneIsDrawnOverThePictureAndLetsThePartThrough) {
    const TracedObjects objects =
        readTracedObjects({test::objectOf(test::sourceDir() / "data/gcode/tile.gcode")}, test::coarseTracing());
    StageOptions options;
    options.render.width = 80;
    options.render.height = 60;
    shade::SceneDescription scene = makeStage(objects, options).scene;
    const HotEnd clear(objects, scene, {HotEndKind::clear});
    EXPECT_TRUE(scene.objects.empty());
    EXPECT_EQ(clear.at(0), objects.intersector);
    const shade::Film empty(80, 60, {0, 0, 80, 60});
    shade::Film film = empty;
    for (shade::Pixel& pixel : film.pixels()) pixel = {shade::Color(0.5F), 1.0F};
    shade::Film twice = film;
    clear.drawOver(0, scene.camera, 1.0, film);
    int drawn = 0;
    for (const shade::Pixel& pixel : film.pixels()) {
        EXPECT_FLOAT_EQ(pixel.alpha, 1.0F);
        EXPECT_GE(pixel.rgb.g, 0.5F * 0.09F);  // nine tenths are covered at most
        EXPECT_LE(pixel.rgb.r, 1.0F);
        drawn += pixel.rgb != shade::Color(0.5F) ? 1 : 0;
    }
    EXPECT_GT(drawn, 20);
    EXPECT_LT(drawn, 80 * 60 / 2);
    // Twice as bright a film has twice as bright glass.
    for (shade::Pixel& pixel : twice.pixels()) pixel.rgb *= 2.0F;
    clear.drawOver(0, scene.camera, 2.0, twice);
    for (std::size_t n = 0; n < film.pixels().size(); ++n)
        EXPECT_NEAR(twice.pixels()[n].rgb.g, 2 * film.pixels()[n].rgb.g, 1e-5);
    // A crop is the whole picture's pixels, and a solid one draws nothing.
    shade::Film crop(80, 60, {20, 10, 60, 40});
    for (shade::Pixel& pixel : crop.pixels()) pixel = {shade::Color(0.5F), 1.0F};
    const shade::Film before = crop;
    HotEnd(objects, scene, {HotEndKind::metal}).drawOver(0, scene.camera, 1.0, crop);
    EXPECT_EQ(crop.at(30, 20).rgb, before.at(30, 20).rgb);
    clear.drawOver(0, scene.camera, 1.0, crop);
    for (int y = 10; y < 40; ++y)
        for (int x = 20; x < 60; ++x) EXPECT_EQ(crop.at(x, y).rgb, film.at(x, y).rgb);
}

}  // namespace
}  // namespace stratum::assemble
