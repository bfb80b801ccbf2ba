#include "trace/clip_intersector.h"

#include "base/error.h"
#include "trace/convex_solid.h"
#include "trace/sdf.h"
#include "trace/sdf_intersector.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace stratum::trace {
namespace {

std::shared_ptr<const Intersector> ball() {
    return std::shared_ptr<const Intersector>(makeSdfIntersector(sdfSphere({0, 0, 0}, 2), 1e-6));
}

std::vector<Ray> someRays(std::size_t count) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    std::vector<Ray> rays(count);
    for (Ray& ray : rays) {
        ray.origin = 6.0 * glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
        ray.direction = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)) - ray.origin);
    }
    return rays;
}

TEST(ClipIntersector, WithoutPlanesItIsTheShape) {
    const auto shape = ball();
    EXPECT_EQ(makeClipIntersector(shape, {}), shape);
}

TEST(ClipIntersector, ACutIsClosedAndFlat) {
    const auto half = makeClipIntersector(ball(), {{{0, 0, 3}, 3}});  // z <= 1
    const auto tracer = half->makeTracer();
    Hit hit;
    ASSERT_TRUE(tracer->intersect({{0.5, 0, 9}, {0, 0, -1}, 0, kInfinity}, hit));
    EXPECT_NEAR(hit.position.z, 1.0, 1e-12);
    EXPECT_EQ(hit.normal, glm::dvec3(0, 0, 1));
    EXPECT_EQ(tracer->shadingNormal(hit), hit.normal);
    ASSERT_TRUE(tracer->intersect({{0, 0, -9}, {0, 0, 1}, 0, kInfinity}, hit));
    EXPECT_NEAR(hit.position.z, -2.0, 1e-4);
    EXPECT_FALSE(tracer->intersect({{-9, 0, 1.5}, {1, 0, 0}, 0, kInfinity}, hit));  // above the cut
    EXPECT_FALSE(tracer->intersect({{0.5, 0, 9}, {0, 0, -1}, 0, 7.5}, hit));        // too short
    EXPECT_TRUE(tracer->occluded({{0.5, 0, 9}, {0, 0, -1}, 0, 8.5}));
    EXPECT_FALSE(tracer->occluded({{0.5, 0, 9}, {0, 0, -1}, 0, 7.5}));
}

// A slab of a ball by arithmetic: the ray's interval within the ball and between the planes.
TEST(ClipIntersector, AgreesWithArithmetic) {
    const auto slab = makeClipIntersector(ball(), {{{0, 0, 1}, 0.7}, {{0, 0, -1}, 0.4}});  // -0.4 <= z <= 0.7
    const auto tracer = slab->makeTracer();
    int hits = 0;
    for (const Ray& ray : someRays(3000)) {
        const double b = glm::dot(ray.origin, ray.direction);
        const double c = glm::dot(ray.origin, ray.origin) - 4.0;
        const double root = b * b - c;
        double from = kInfinity;
        double to = -kInfinity;
        if (root > 0) {
            const double t0 = (-0.4 - ray.origin.z) / ray.direction.z;
            const double t1 = (0.7 - ray.origin.z) / ray.direction.z;
            from = std::max({-b - std::sqrt(root), std::min(t0, t1), 0.0});
            to = std::min(-b + std::sqrt(root), std::max(t0, t1));
        }
        if (std::abs(to - from) < 1e-3) continue;  // touches an edge
        Hit hit;
        const bool found = tracer->intersect(ray, hit);
        ASSERT_EQ(found, from < to);
        EXPECT_EQ(tracer->occluded(ray), found);
        if (!found) continue;
        ++hits;
        EXPECT_NEAR(hit.t, from, 1e-4);
        EXPECT_LT(glm::dot(hit.normal, ray.direction), 1e-9);
    }
    EXPECT_GT(hits, 200);
}

TEST(ClipIntersector, StreamsAreTheSame) {
    const auto slab = makeClipIntersector(ball(), {{{1, 1, 1}, 0.5}, {{0, -1, 0}, 0.6}});
    const auto tracer = slab->makeTracer();
    const std::vector<Ray> rays = someRays(1000);
    std::vector<Hit> hits(rays.size());
    std::vector<std::uint8_t> blocked(rays.size());
    tracer->intersectStream(rays, hits);
    tracer->occludedStream(rays, blocked);
    for (std::size_t n = 0; n < rays.size(); ++n) {
        Hit hit;
        const bool found = tracer->intersect(rays[n], hit);
        EXPECT_EQ(std::isfinite(hits[n].t), found);
        EXPECT_EQ(blocked[n] != 0, tracer->occluded(rays[n]));
        if (found) {
            EXPECT_EQ(hits[n].t, hit.t);
            EXPECT_EQ(hits[n].normal, hit.normal);
        }
    }
}

// A box that was drawn by a nozzle, along x.
class Printed final : public Intersector {
public:
    std::unique_ptr<Tracer> makeTracer() const override { return std::make_unique<Lines>(box_->makeTracer()); }
    std::string_view name() const override { return box_->name(); }
    Box bounds() const override { return box_->bounds(); }
    double voxelSize() const override { return box_->voxelSize(); }
    std::size_t bytes() const override { return box_->bytes(); }
    double surfaceOffset() const override { return box_->surfaceOffset(); }

private:
    class Lines final : public Tracer {
    public:
        explicit Lines(std::unique_ptr<Tracer> box) : box_(std::move(box)) {}
        bool intersect(const Ray& ray, Hit& hit) override { return box_->intersect(ray, hit); }
        bool occluded(const Ray& ray) override { return box_->occluded(ray); }
        glm::dvec3 grain(const Hit&) override { return {1, 0, 0}; }

    private:
        const std::unique_ptr<Tracer> box_;
    };
    const std::shared_ptr<const Intersector> box_ = makeBoxSolid({-1, -1, -1}, {1, 1, 1});
};

// A flat top has the normal of a level cut above it.
TEST(ClipIntersector, OnlyTheCutHasNoGrain) {
    const Ray down{{0.5, 0, 9}, {0, 0, -1}, 0, kInfinity};
    for (const bool cuts : {false, true}) {
        const auto part = makeClipIntersector(std::make_shared<Printed>(), {{{0, 0, 1}, cuts ? 0.5 : 100.0}});
        const auto tracer = part->makeTracer();
        std::vector<Hit> hits(1);
        tracer->intersectStream({&down, 1}, hits);
        EXPECT_EQ(tracer->grain(hits[0]), glm::dvec3(cuts ? 0 : 1, 0, 0));
        EXPECT_EQ(hits[0].normal, glm::dvec3(0, 0, 1));
    }
}

TEST(ClipIntersector, PlanesWithoutADirectionAreRefused) {
    EXPECT_THROW((void)makeClipIntersector(ball(), {{{0, 0, 0}, 1}}), UsageError);
    EXPECT_THROW((void)makeClipIntersector(ball(), {{{0, 0, 1}, std::numeric_limits<double>::quiet_NaN()}}),
                 UsageError);
}

}  // namespace
}  // namespace stratum::trace
