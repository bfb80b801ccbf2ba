#include "trace/sdf.h"

#include "base/error.h"
#include "trace/scene_intersector.h"

#include <gtest/gtest.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <cmath>
#include <random>

namespace stratum::trace {
namespace {

TEST(Sdf, DistancesAreThoseOnPaper) {
    const auto sphere = sdfSphere({1, 2, 3}, 2);
    EXPECT_DOUBLE_EQ(sphere->distance({1, 2, 8}), 3);
    EXPECT_DOUBLE_EQ(sphere->distance({1, 2, 3}), -2);
    const auto box = sdfBox({0, 0, 0}, {1, 2, 3});
    EXPECT_DOUBLE_EQ(box->distance({4, 6, 3}), 5);
    EXPECT_DOUBLE_EQ(box->distance({0, 0, 0}), -1);
    EXPECT_DOUBLE_EQ(box->distance({0, 1.5, 0}), -0.5);
    const auto torus = sdfTorus({0, 0, 1}, 3, 1, 2);
    EXPECT_DOUBLE_EQ(torus->distance({0, 0, 1}), 2);
    EXPECT_DOUBLE_EQ(torus->distance({3, 0, 1}), -1);
    EXPECT_DOUBLE_EQ(torus->distance({0, 7, 4}), 4);
    const auto cylinder = sdfCylinder({0, 0, 0}, 1, 2, 1);
    EXPECT_DOUBLE_EQ(cylinder->distance({0, 6, 4}), 5);
    EXPECT_DOUBLE_EQ(cylinder->distance({0, 1.75, 0}), -0.25);
    const auto plane = sdfPlane({0, 0, 2}, -3);
    EXPECT_DOUBLE_EQ(plane->distance({5, 5, 1}), 4);
    EXPECT_EQ(plane->bounds().max.z, -3);
    EXPECT_FALSE(std::isfinite(plane->bounds().min.z));
}

TEST(Sdf, OperationsAreThoseOfSets) {
    const auto a = sdfSphere({0, 0, 0}, 1);
    const auto b = sdfSphere({1, 0, 0}, 1);
    const glm::dvec3 in_a(-0.5, 0, 0);
    const glm::dvec3 in_b(1.5, 0, 0);
    const glm::dvec3 in_both(0.5, 0, 0);
    const auto inside = [](const SdfPtr& s, const glm::dvec3& p) { return s->distance(p) < 0; };
    for (const auto& p : {in_a, in_b, in_both}) EXPECT_TRUE(inside(sdfUnion({a, b}), p));
    EXPECT_TRUE(inside(sdfIntersection({a, b}), in_both));
    EXPECT_FALSE(inside(sdfIntersection({a, b}), in_a));
    EXPECT_TRUE(inside(sdfSubtraction({a, b}), in_a));
    EXPECT_FALSE(inside(sdfSubtraction({a, b}), in_both));
    EXPECT_FALSE(inside(sdfSubtraction({a, b}), in_b));
    EXPECT_EQ(sdfUnion({a, b})->bounds().max, glm::dvec3(2, 1, 1));
    EXPECT_EQ(sdfIntersection({a, b})->bounds().min, glm::dvec3(0, -1, -1));
    // Each part is asked once: time does not double with depth.
    SdfPtr nested = a;
    for (int depth = 0; depth < 60; ++depth) nested = sdfIntersection({nested});
    EXPECT_EQ(nested->bounds().min, a->bounds().min);
}

TEST(Sdf, NoStepIsTooLong) {
    // |distance| bounds the way to the surface: no two points of other signs are nearer than that.
    const auto turned = Placement::of({1, 1, 1}, {20, 40, 60}, {0, 0, 0}).linear;
    const std::vector<SdfPtr> shapes{
        sdfSubtraction({sdfBox({0, 0, 0}, {1, 1, 1}), sdfSphere({0.5, 0.5, 0.5}, 0.9)}),
        sdfMoved(sdfIntersection({sdfTorus({0, 0, 0}, 1, 0.4, 0), sdfPlane({1, 1, 1}, 0.3)}), turned, {0.2, 0, 0}),
        sdfRepetition(sdfUnion({sdfSphere({0, 0, 0}, 0.3), sdfCylinder({0, 0, 0}, 0.1, 0.4, 2)}), {0.9, 1.2, 1.0}, -1),
        sdfRepetition(sdfBox({0.1, 0, 0}, {0.3, 0.3, 0.3}), {0.9, 0, 0}, 2)};
    std::mt19937 random(3);
    std::uniform_real_distribution<double> where(-2.5, 2.5);
    const auto point = [&] { return glm::dvec3(where(random), where(random), where(random)); };
    for (std::size_t s = 0; s < shapes.size(); ++s) {
        int pairs = 0;
        for (int n = 0; n < 200000; ++n) {
            const glm::dvec3 p = point();
            const double d = shapes[s]->distance(p);
            // A point on the sphere that must be free, and the Lipschitz bound between the two.
            const glm::dvec3 way = glm::normalize(point());
            const double e = shapes[s]->distance(p + 0.999 * std::abs(d) * way);
            EXPECT_FALSE(std::abs(d) > 1e-9 && e * d < 0) << s << " " << d << " " << e;
            ++pairs;
        }
        EXPECT_EQ(pairs, 200000);
    }
}

TEST(Sdf, RepeatsExactlyAndEndsWhereItShould) {
    const auto one = sdfSphere({0.1, 0, 0}, 0.3);
    const auto row = sdfRepetition(one, {1, 0, 0}, 2);
    const auto endless = sdfRepetition(one, {1, 0, 0}, -1);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> where(-6, 6);
    for (int n = 0; n < 20000; ++n) {
        const glm::dvec3 p(where(random), 0.3 * where(random), 0.3 * where(random));
        double five = 1e9;
        double many = 1e9;
        for (int k = -9; k <= 9; ++k) {
            const double d = one->distance(p - glm::dvec3(k, 0, 0));
            many = std::min(many, d);
            if (std::abs(k) <= 2) five = std::min(five, d);
        }
        EXPECT_NEAR(row->distance(p), five, 1e-12);
        EXPECT_NEAR(endless->distance(p), many, 1e-12);
    }
    EXPECT_NEAR(row->bounds().max.x, 2.4, 1e-12);
    EXPECT_FALSE(std::isfinite(endless->bounds().max.x));
    EXPECT_THROW(sdfRepetition(one, {0.5, 0, 0}, -1), UsageError);
    EXPECT_THROW(sdfRepetition(sdfSphere({5, 0, 0}, 0.1), {1, 0, 0}, -1), UsageError);
}

TEST(Sdf, TurnsAndMoves) {
    const auto turned =
        sdfMoved(sdfBox({0, 0, 0}, {1, 2, 3}), Placement::of({1, 1, 1}, {0, 0, 90}, {0, 0, 0}).linear, {10, 0, 0});
    EXPECT_NEAR(turned->distance({13, 0, 0}), 1, 1e-12);
    EXPECT_EQ(turned->bounds().max, glm::dvec3(12, 1, 3));
    EXPECT_THROW(sdfMoved(sdfSphere({0, 0, 0}, 1), glm::dmat3(2.0), {0, 0, 0}), UsageError);
}

TEST(Sdf, RefusesWhatIsNoShape) {
    EXPECT_THROW(sdfSphere({0, 0, 0}, 0), UsageError);
    EXPECT_THROW(sdfSphere({0, 0, 0}, std::nan("")), UsageError);
    EXPECT_THROW(sdfSphere({0, INFINITY, 0}, 1), UsageError);
    EXPECT_THROW(sdfBox({0, 0, 0}, {1, -1, 1}), UsageError);
    EXPECT_THROW(sdfTorus({0, 0, 0}, 1, 0, 0), UsageError);
    EXPECT_THROW(sdfPlane({0, 0, 0}, 1), UsageError);
    EXPECT_THROW(sdfUnion({}), UsageError);
}

}  // namespace
}  // namespace stratum::trace
