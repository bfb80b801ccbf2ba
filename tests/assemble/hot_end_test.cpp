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
    const auto both = withHotEnd(ball, tip);
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
    const HotEnd hot_end(objects, scene);
    ASSERT_EQ(scene.objects.size(), 6u);
    EXPECT_EQ(scene.objects.front().only().brdf, scene.material);
    const shade::Color brass = scene.objects[1].only().albedo;
    EXPECT_GT(brass.r, brass.b);
}

}  // namespace
}  // namespace stratum::assemble
