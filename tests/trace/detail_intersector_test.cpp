#include "trace/detail_intersector.h"

#include "base/error.h"
#include "base/parallel_for.h"
#include "march/brick/brick_intersector.h"
#include "random_rays.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace stratum::trace {
namespace {

// A torus about z with a wave along it: closed, bent everywhere, with a hole.
double solid(const glm::dvec3& p) {
    const double around = std::atan2(p.y, p.x);
    return std::hypot(std::hypot(p.x, p.y) - 6.0, p.z) - (2.0 + 0.2 * std::sin(9 * around));
}

std::shared_ptr<const Intersector> sampled(double voxel) {
    openvdb::initialize();
    const auto grid = openvdb::FloatGrid::create(static_cast<float>(3 * voxel));
    grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    auto accessor = grid->getAccessor();
    const int side = static_cast<int>(std::ceil(9.0 / voxel));
    const int high = static_cast<int>(std::ceil(3.0 / voxel));
    for (int i = -side; i <= side; ++i)
        for (int j = -side; j <= side; ++j)
            for (int k = -high; k <= high; ++k) {
                const double d = solid(glm::dvec3(i, j, k) * voxel);
                if (std::abs(d) < 3 * voxel)
                    accessor.setValue({i, j, k}, static_cast<float>(d));
                else if (d < 0)
                    accessor.setValueOff({i, j, k}, static_cast<float>(-3 * voxel));
            }
    return march::makeBrickIntersector(*grid);
}

// Voxels of three sizes, and an eye from which the spheres between them cut the tube, once near its crest.
struct Levels {
    std::vector<DetailLevel> all{{sampled(0.15), 0}, {sampled(0.3), 5.0}, {sampled(0.6), 8.5}};
    glm::dvec3 eye{9.5, -1.0, 2.5};
    std::shared_ptr<const Intersector> composite = makeDetailIntersector(all, eye);

    std::size_t levelAt(const glm::dvec3& p) const {
        std::size_t level = all.size();
        while (level > 1 && glm::length(p - eye) < all[level - 1].from) --level;
        return level - 1;
    }
};

const Levels& levels() {
    static const Levels the_levels;
    return the_levels;
}

std::vector<Ray> raysOfAllKinds(std::size_t count) {
    std::vector<Ray> rays = test::randomRays(count, 9.0, 0.6, 3);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> where(-9, 9);
    for (std::size_t n = 0; n < count; ++n) {
        Ray ray;
        ray.origin = levels().eye;
        // From the eye, and such that graze the spheres.
        const glm::dvec3 target(where(random), where(random), 0.3 * where(random));
        ray.direction = glm::normalize(target - ray.origin);
        if (n % 3 == 1) {
            const glm::dvec3 out = test::randomDirection(random);
            const double radius = levels().all[1 + n % 2].from * (1 + (n % 5 == 0 ? 0.0 : 1e-3 * where(random)));
            ray.direction = glm::normalize(glm::cross(out, test::randomDirection(random)));
            ray.origin = levels().eye + radius * out - 20.0 * ray.direction;
        }
        rays.push_back(ray);
    }
    return rays;
}

// Within the sum of what two levels may be off. A trilinear field of exact distances bends no more than this below its
// samples: a sixth of the voxel's square times the curvature of a tube of radius 1.8 (all principal ones below 1.2).
double errorOf(double voxel) { return 0.4 * voxel * voxel * 1.2 + 3.0 * voxel / 32767; }

TEST(DetailIntersector, LeaksNowhere) {
    const Levels& l = levels();
    const auto fine = l.all[0].shape->makeTracer();
    const auto tracer = l.composite->makeTracer();
    const double off = errorOf(0.15) + errorOf(0.6);
    std::size_t hits = 0;
    std::size_t shallow = 0;
    std::vector<std::size_t> met(3);
    for (const Ray& ray : raysOfAllKinds(60000)) {
        if (ray.t_min > 0 || std::isfinite(ray.t_max) || solid(ray.origin) < off) continue;
        Hit expected;
        Hit found;
        const bool any = fine->intersect(ray, expected);
        const bool composite = tracer->intersect(ray, found);
        EXPECT_EQ(tracer->occluded(ray), composite);
        // How deep it goes.
        double depth = kInfinity;
        if (any)
            for (double t = expected.t; t < expected.t + 20; t += 0.05)
                depth = std::min(depth, solid(ray.origin + t * ray.direction));
        if (any && depth < -off) {
            ++hits;
            ASSERT_TRUE(composite);
        }
        if (!composite) continue;
        if (depth >= -off) ++shallow;
        ++met[found.part];
        // On the surface, whichever way it was found, and seen from outside.
        EXPECT_LE(std::abs(solid(found.position)), off);
        EXPECT_LE(glm::dot(found.normal, ray.direction), 1e-9);
        EXPECT_NEAR(glm::length(found.normal), 1, 1e-12);
        if (any && depth < -off) {
            // The first place at which it is as deep as both may be off lies behind both.
            double deep = expected.t;
            while (solid(ray.origin + deep * ray.direction) > -off) deep += 0.01;
            EXPECT_LE(found.t, deep + 0.01);
        }
    }
    EXPECT_GT(hits, 10000U);
    EXPECT_GT(shallow, 10U);
    for (const std::size_t n : met) EXPECT_GT(n, 1000U);
}

// The nearest crossing of all levels' whole ways that lies where its level answers. Only where none of them is near a
// wall: there the composite is more than its parts.
TEST(DetailIntersector, IsEachLevelInItsShell) {
    const Levels& l = levels();
    const auto tracer = l.composite->makeTracer();
    std::vector<std::unique_ptr<Tracer>> own;
    for (const DetailLevel& level : l.all) own.push_back(level.shape->makeTracer());
    std::size_t compared = 0;
    std::size_t missed = 0;
    for (const Ray& ray : raysOfAllKinds(20000)) {
        Hit expected;
        expected.t = kInfinity;
        bool wall = false;
        for (std::size_t n = 0; n < own.size(); ++n) {
            Ray rest = ray;
            Hit hit;
            while (own[n]->intersect(rest, hit)) {
                const double r = glm::length(hit.position - l.eye);
                for (std::size_t k = 1; k < l.all.size(); ++k) wall = wall || std::abs(r - l.all[k].from) < 0.6;
                if (l.levelAt(hit.position) == n && hit.t < expected.t) {
                    expected = hit;
                    expected.part = static_cast<std::uint32_t>(n);
                }
                rest.t_min = hit.t + 1e-6;
                if (!(rest.t_min < rest.t_max)) break;
            }
        }
        if (wall) continue;
        Hit found;
        const bool any = tracer->intersect(ray, found);
        ASSERT_EQ(any, std::isfinite(expected.t));
        ASSERT_EQ(tracer->occluded(ray), any);
        if (!any) {
            ++missed;
            continue;
        }
        ++compared;
        ASSERT_NEAR(found.t, expected.t, 1e-7 * std::max(1.0, std::abs(expected.t)));
        ASSERT_EQ(found.part, expected.part);
        ASSERT_LE(glm::length(found.normal - expected.normal), 1e-6);
    }
    EXPECT_GT(compared, 5000U);
    EXPECT_GT(missed, 5000U);
}

TEST(DetailIntersector, AnswersStreamsAsItAnswersRays) {
    const std::vector<Ray> rays = raysOfAllKinds(8000);
    const auto one = levels().composite->makeTracer();
    std::vector<Hit> expected(rays.size());
    std::vector<std::uint8_t> blocked_one(rays.size());
    one->Tracer::intersectStream(rays, expected);
    one->Tracer::occludedStream(rays, blocked_one);
    parallelFor(4, 1, [&](std::size_t, std::size_t) {
        const auto tracer = levels().composite->makeTracer();
        // Memory that had other hits, as the callers' has, and once more.
        Hit other;
        other.part = 77;
        std::vector<Hit> found(rays.size(), other);
        std::vector<std::uint8_t> blocked(rays.size(), 1);
        for (int again = 0; again < 2; ++again) {
            tracer->intersectStream(rays, found);
            tracer->occludedStream(rays, blocked);
            EXPECT_EQ(blocked, blocked_one);
            for (std::size_t n = 0; n < rays.size(); ++n) {
                ASSERT_EQ(found[n].t, expected[n].t) << n;
                if (!std::isfinite(found[n].t)) continue;
                ASSERT_EQ(found[n].normal, expected[n].normal) << n;
                ASSERT_EQ(found[n].position, expected[n].position) << n;
                ASSERT_EQ(found[n].part, expected[n].part) << n;
            }
        }
        tracer->intersectStream({}, {});
    });
}

// A ray that begins in the solid comes out: no wall is made of that. Hardly one comes out through a wall.
TEST(DetailIntersector, LetsRaysOutThatBeganInside) {
    const auto tracer = levels().composite->makeTracer();
    std::mt19937 random(11);
    int unnoticed = 0;
    for (int n = 0; n < 3000; ++n) {
        const double around = 2 * std::numbers::pi * n / 3000;
        Ray ray;
        ray.origin = {6 * std::cos(around), 6 * std::sin(around), 0};
        ray.direction = test::randomDirection(random);
        Hit hit;
        if (!tracer->intersect(ray, hit) || glm::dot(hit.normal, ray.direction) < -1e-9) {
            ++unnoticed;
            continue;
        }
        EXPECT_LE(std::abs(solid(hit.position)), errorOf(0.15) + errorOf(0.6));
    }
    EXPECT_LE(unnoticed, 5);
}

// Says which of a detail intersector's parts it is asked as.
class Signed final : public Intersector {
public:
    Signed(std::shared_ptr<const Intersector> shape, float sign) : shape_(std::move(shape)), sign_(sign) {}
    std::unique_ptr<Tracer> makeTracer() const override {
        class SignedTracer final : public Tracer {
        public:
            SignedTracer(std::unique_ptr<Tracer> rays, float sign) : rays_(std::move(rays)), sign_(sign) {}
            bool intersect(const Ray& ray, Hit& hit) override { return rays_->intersect(ray, hit); }
            bool occluded(const Ray& ray) override { return rays_->occluded(ray); }
            glm::dvec3 shadingNormal(const Hit&) override { return {0, 0, sign_}; }
            std::optional<glm::vec3> attribute(const Hit& hit, std::size_t) override {
                return glm::vec3(sign_, hit.part, 0);
            }

        private:
            std::unique_ptr<Tracer> rays_;
            float sign_;
        };
        return std::make_unique<SignedTracer>(shape_->makeTracer(), sign_);
    }
    std::string_view name() const override { return shape_->name(); }
    Box bounds() const override { return shape_->bounds(); }
    double voxelSize() const override { return shape_->voxelSize(); }
    std::size_t bytes() const override { return 100; }
    double surfaceOffset() const override { return shape_->surfaceOffset(); }

private:
    std::shared_ptr<const Intersector> shape_;
    float sign_;
};

TEST(DetailIntersector, AsksTheLevelThatWasHitWhatIsThere) {
    std::vector<DetailLevel> marked = levels().all;
    for (std::size_t n = 0; n < marked.size(); ++n)
        marked[n].shape = std::make_shared<Signed>(marked[n].shape, static_cast<float>(n + 1));
    const auto inner = makeDetailIntersector(marked, levels().eye);
    // One of levels that are such themselves.
    const auto outer = makeDetailIntersector({{inner, 0}, {inner, 7.0}}, levels().eye);
    EXPECT_EQ(inner->bytes(), 300U);
    const auto tracer = outer->makeTracer();
    std::size_t hits = 0;
    for (const Ray& ray : raysOfAllKinds(2000)) {
        Hit hit;
        if (!tracer->intersect(ray, hit)) continue;
        ++hits;
        const auto value = tracer->attribute(hit, 0);
        ASSERT_TRUE(value);
        EXPECT_EQ(value->x, static_cast<float>(hit.part / 2 + 1));
        EXPECT_EQ(value->y, 0.0F);
        EXPECT_EQ(tracer->shadingNormal(hit).z, static_cast<double>(hit.part / 2 + 1));
    }
    EXPECT_GT(hits, 500U);
}

TEST(DetailIntersector, IsTheLevelIfThereIsOne) {
    EXPECT_EQ(makeDetailIntersector({levels().all.front()}, glm::dvec3(0)), levels().all.front().shape);
    EXPECT_EQ(levels().composite->voxelSize(), levels().all.front().shape->voxelSize());
    EXPECT_EQ(levels().composite->surfaceOffset(), levels().all.back().shape->surfaceOffset());
    EXPECT_EQ(levels().composite->bounds().min, levels().all.back().shape->bounds().min);
}

TEST(DetailIntersector, RefusesLevelsOutOfOrder) {
    const auto& all = levels().all;
    EXPECT_THROW(makeDetailIntersector({}, glm::dvec3(0)), UsageError);
    EXPECT_THROW(makeDetailIntersector({all[1]}, glm::dvec3(0)), UsageError);
    EXPECT_THROW(makeDetailIntersector({all[0], all[2], all[1]}, glm::dvec3(0)), UsageError);
    EXPECT_THROW(makeDetailIntersector({all[0], {all[1].shape, kInfinity}}, glm::dvec3(0)), UsageError);
    EXPECT_THROW(makeDetailIntersector(std::vector<DetailLevel>(9, all[0]), glm::dvec3(0)), UsageError);
}

}  // namespace
}  // namespace stratum::trace
