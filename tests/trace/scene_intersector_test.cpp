#include "trace/scene_intersector.h"

#include "base/error.h"
#include "march/brick/brick_intersector.h"
#include "random_rays.h"
#include "rubble.h"
#include "trace/sdf_intersector.h"

#include <gtest/gtest.h>
#include <openvdb/tools/Composite.h>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <cmath>
#include <set>

namespace stratum::trace {
namespace {

std::shared_ptr<const Intersector> ball(const openvdb::Vec3f& center, float radius) {
    return march::makeBrickIntersector(*test::sphereGrid(radius, center, 0.1F));
}

TEST(SceneIntersector, ASingleObjectInItsPlaceIsItself) {
    const auto shape = ball(openvdb::Vec3f(0), 1);
    EXPECT_EQ(makeSceneIntersector({{shape, {}}}).get(), shape.get());
    EXPECT_NE(makeSceneIntersector({{shape, {glm::dmat3(1.0), {1, 0, 0}}}}).get(), shape.get());
}

TEST(SceneIntersector, PlacesByScaleTurnsAndOffset) {
    const Placement p = Placement::of({2, 1, 1}, {0, 0, 90}, {5, 0, 0});
    const glm::dvec3 tip = p.linear * glm::dvec3(1, 0, 0) + p.offset;
    EXPECT_EQ(tip, glm::dvec3(5, 2, 0));
    const Placement up = Placement::of({1, 1, 1}, {90, 0, 0}, {0, 0, 0});
    EXPECT_EQ(up.linear * glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1));
    const Placement both = Placement::of({1, 1, 1}, {90, 0, 90}, {0, 0, 0});
    EXPECT_EQ(both.linear * glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0));  // about x to -y, then about z to x
    EXPECT_TRUE(Placement::of({1, 1, 1}, {0, 0, 0}, {0, 0, 0}).isIdentity());
}

TEST(SceneIntersector, FindsTheNearestOfAll) {
    // Overlapping balls, one of them twice, against the union of the same in one grid, whose field is the minimum.
    const auto one = test::sphereGrid(1, openvdb::Vec3f(0), 0.1F);
    const Placement aside{glm::dmat3(1.0), {1.5, 0.3, 0}};
    const auto shape = std::shared_ptr<const Intersector>(march::makeBrickIntersector(*one));
    const auto other = ball(openvdb::Vec3f(-1.2F, 0.4F, 0.9F), 0.8F);
    const auto scene = makeSceneIntersector({{shape, {}}, {other, {}}, {shape, aside}});
    const auto tracer = scene->makeTracer();
    std::vector<std::unique_ptr<Tracer>> alone;
    alone.push_back(shape->makeTracer());
    alone.push_back(other->makeTracer());
    alone.push_back(ball(openvdb::Vec3f(1.5F, 0.3F, 0), 1)->makeTracer());
    int hits = 0;
    int objects[3] = {0, 0, 0};
    const auto third = ball(openvdb::Vec3f(1.5F, 0.3F, 0), 1);
    alone[2] = third->makeTracer();
    for (const Ray& ray : test::randomRays(20000, 3.0, 0.1, 5)) {
        Hit best;
        bool found = false;
        for (const auto& a : alone) {
            Hit hit;
            if (a->intersect(ray, hit) && (!found || hit.t < best.t)) {
                best = hit;
                found = true;
            }
        }
        Hit hit;
        // The third ball's lattice is another than the moved one's: rays that graze it may differ.
        if (tracer->intersect(ray, hit) != found) {
            EXPECT_TRUE(!found || best.object != 2);
            continue;
        }
        EXPECT_EQ(tracer->occluded(ray), found);
        if (!found) continue;
        ++hits;
        ++objects[hit.object];
        EXPECT_NEAR(hit.t, best.t, hit.object == 2 ? 0.2 : 1e-9);
        EXPECT_NEAR(glm::length(hit.position - (ray.origin + hit.t * ray.direction)), 0,
                    1e-12 * (1 + glm::length(ray.origin)));
    }
    EXPECT_GT(hits, 4000);
    for (const int count : objects) EXPECT_GT(count, 300);
}

TEST(SceneIntersector, StreamsGiveTheSameBits) {
    const auto shape = std::shared_ptr<const Intersector>(march::makeBrickIntersector(*test::rubble(0.1F, false)));
    const auto scene = makeSceneIntersector({{shape, {}},
                                             {shape, Placement::of({0.5, 0.5, 0.7}, {10, 20, 30}, {3, 1, 0})},
                                             {shape, {glm::dmat3(1.0), {-2, -6, 0}}}});
    const auto tracer = scene->makeTracer();
    const std::vector<Ray> rays = test::randomRays(6000, 6.0, 0.1, 8);
    std::vector<Hit> hits(rays.size());
    std::vector<std::uint8_t> blocked(rays.size());
    tracer->intersectStream(rays, hits);
    tracer->occludedStream(rays, blocked);
    int objects[3] = {0, 0, 0};
    for (std::size_t n = 0; n < rays.size(); ++n) {
        Hit hit;
        const bool found = tracer->intersect(rays[n], hit);
        ASSERT_EQ(found, std::isfinite(hits[n].t)) << n;
        ASSERT_EQ(blocked[n] != 0, found) << n;
        if (!found) continue;
        ASSERT_EQ(hits[n].t, hit.t);
        ASSERT_EQ(hits[n].normal, hit.normal);
        ASSERT_EQ(hits[n].object, hit.object);
        ++objects[hit.object];
    }
    for (const int count : objects) EXPECT_GT(count, 100);
}

/// `count` copies of two shapes: on a plate, some turned, some exactly in the same place, and a plane without an end.
std::vector<SceneObject> crowd(int count) {
    const auto shape = std::shared_ptr<const Intersector>(march::makeBrickIntersector(*test::rubble(0.2F, false)));
    const auto other = ball(openvdb::Vec3f(0.05F, 0, 0), 1);
    std::vector<SceneObject> objects;
    for (int n = 0; n < count; ++n) {
        const glm::dvec3 place(3.0 * (n % 8 - 4), 3.0 * (n / 8 - 4), 0.2 * (n % 3));
        const auto& which = n % 3 == 0 ? shape : other;
        if (n % 5 == 4)
            objects.push_back(objects[static_cast<std::size_t>(n / 2)]);
        else
            objects.push_back(
                {which, Placement::of(glm::dvec3(n % 4 == 0 ? 0.7 : 1.0),
                                      n % 4 == 1 ? glm::dvec3(10.0 * n, 20, 30) : glm::dvec3(0.0), place)});
    }
    const SdfPtr floor = sdfPlane({0, 0, 1}, -3.0);
    objects[3] = {std::shared_ptr<const Intersector>(makeSdfIntersector(floor, 1e-4)), {}};
    return objects;
}

TEST(SceneIntersector, TheTreeOfManyObjectsGivesTheBitsOfTheLoop) {
    for (const int count : {8, 70}) {
        const std::vector<SceneObject> objects = crowd(count);
        const auto treed = makeSceneIntersector(objects, 0);
        const auto plain = makeSceneIntersector(objects, objects.size() + 1);
        EXPECT_GT(treed->bytes(), plain->bytes());
        const auto tree = treed->makeTracer();
        const auto loop = plain->makeTracer();
        const std::vector<Ray> rays = test::randomRays(4000, 12.0, 0.2, 9);
        std::vector<Hit> hits(rays.size());
        std::vector<Hit> loop_hits(rays.size());
        std::vector<std::uint8_t> blocked(rays.size());
        std::vector<std::uint8_t> loop_blocked(rays.size());
        tree->intersectStream(rays, hits);
        loop->intersectStream(rays, loop_hits);
        tree->occludedStream(rays, blocked);
        loop->occludedStream(rays, loop_blocked);
        std::set<std::uint32_t> seen;
        for (std::size_t n = 0; n < rays.size(); ++n) {
            Hit hit;
            Hit loop_hit;
            const bool found = loop->intersect(rays[n], loop_hit);
            ASSERT_EQ(tree->intersect(rays[n], hit), found) << n;
            ASSERT_EQ(tree->occluded(rays[n]), loop->occluded(rays[n])) << n;
            ASSERT_EQ(blocked[n], loop_blocked[n]) << n;
            ASSERT_EQ(hits[n].t, loop_hits[n].t) << n;
            if (!found) continue;
            for (const Hit& other : {hit, hits[n]}) {
                ASSERT_EQ(other.t, loop_hit.t) << n;
                ASSERT_EQ(other.position, loop_hit.position) << n;
                ASSERT_EQ(other.normal, loop_hit.normal) << n;
                ASSERT_EQ(other.object, loop_hit.object) << n;
            }
            seen.insert(hit.object);
        }
        EXPECT_GT(seen.size(), static_cast<std::size_t>(count) / 2);
    }
}

TEST(SceneIntersector, PlacedObjectsHaveWorldUnits) {
    // A ball of radius 1, stretched to an ellipsoid, turned and moved: hits and normals on paper.
    const Placement placement = Placement::of({2, 1, 0.5}, {0, 0, 90}, {10, 0, 0});
    const auto scene = makeSceneIntersector({{ball(openvdb::Vec3f(0), 1), placement}});
    const auto tracer = scene->makeTracer();
    Hit hit;
    ASSERT_TRUE(tracer->intersect({{10, -20, 0}, {0, 1, 0}}, hit));
    EXPECT_NEAR(hit.t, 18, 5e-3);
    EXPECT_LT(hit.normal.y, -0.95);  // the cell's leaning, stretched four times
    ASSERT_TRUE(tracer->intersect({{10, 1, 9}, {0, 0, -1}}, hit));
    EXPECT_NEAR(hit.t, 9 - 0.5 * std::sqrt(0.75), 5e-3);
    const glm::dvec3 normal = glm::normalize(glm::dvec3(0, 1.0 / 4, (9 - hit.t) / 0.25));
    EXPECT_GT(glm::dot(hit.normal, normal), 0.999);
    Ray ray{{10, -20, 0}, {0, 1, 0}, 0, 17.9};
    EXPECT_FALSE(tracer->occluded(ray));
    ray.t_max = 18.1;
    EXPECT_TRUE(tracer->occluded(ray));
    const Box box = scene->bounds();
    EXPECT_NEAR(box.max.y, 2.5, 0.25);
    EXPECT_NEAR(box.max.z, 0.62, 0.07);
    EXPECT_NEAR(box.min.x, 8.8, 0.15);
}

TEST(SceneIntersector, RaysThatLeaveItMeetNothing) {
    const auto scene =
        makeSceneIntersector({{ball(openvdb::Vec3f(0), 1), Placement::of({100, 20, 50}, {10, 20, 30}, {1e4, 0, 0})}});
    const auto tracer = scene->makeTracer();
    std::mt19937 random(2);
    int met = 0;
    int left = 0;
    for (int n = 0; n < 5000; ++n) {
        Ray ray;
        ray.origin = glm::dvec3(1e4, 0, 0) + 400.0 * test::randomDirection(random);
        ray.direction = glm::normalize(glm::dvec3(1e4, 0, 0) + 10.0 * test::randomDirection(random) - ray.origin);
        Hit hit;
        ASSERT_TRUE(tracer->intersect(ray, hit));
        const Ray out{hit.position + scene->surfaceOffset() * hit.normal,
                      glm::normalize(hit.normal + test::randomDirection(random))};
        ++left;
        met += tracer->occluded(out) ? 1 : 0;
    }
    EXPECT_LT(met, left / 200);  // facets of the trilinear field
}

TEST(SceneIntersector, RefusesWhatItCannotPlace) {
    EXPECT_THROW(makeSceneIntersector({}), UsageError);
    const auto shape = ball(openvdb::Vec3f(0), 1);
    EXPECT_THROW(makeSceneIntersector({{shape, Placement::of({1, 0, 1}, {0, 0, 0}, {0, 0, 0})}}), UsageError);
    EXPECT_THROW(makeSceneIntersector({{shape, Placement::of({1, 1, 1}, {0, 0, 0}, {std::nan(""), 0, 0})}}),
                 UsageError);
}

}  // namespace
}  // namespace stratum::trace
