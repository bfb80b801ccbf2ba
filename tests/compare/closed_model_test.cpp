#include "compare/closed_model.h"

#include "shapes.h"

#include "base/error.h"
#include "refusal.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace stratum::compare {
namespace {

double boxDistance(const glm::dvec3& p, const glm::dvec3& half) {
    const glm::dvec3 q = glm::abs(p) - half;
    return glm::length(glm::max(q, glm::dvec3(0.0))) + std::min(std::max({q.x, q.y, q.z}), 0.0);
}

TEST(ClosedModel, DistancesFromABoxAreThoseOfTheFormula) {
    const glm::dvec3 half(3, 2, 1);
    const ClosedModel model(test::boxModel(-half, half), "box");
    test::Numbers random(1);
    std::uint32_t hint = Nearest::kNone;
    for (int n = 0; n < 20000; ++n) {
        const glm::dvec3 p(10 * random() - 5, 10 * random() - 5, 10 * random() - 5);
        const ModelDistance found = model.distance(p, hint);
        ASSERT_NEAR(found.distance, boxDistance(p, half), 1e-12);
        const ModelDistance without = model.distance(p);
        ASSERT_EQ(found.distance, without.distance) << "a hint changes nothing";
        ASSERT_EQ(found.triangle, without.triangle);
        hint = found.triangle;
    }
    EXPECT_NEAR(model.volume(), 48, 1e-12);
    EXPECT_NEAR(model.area(), 88, 1e-12);
}

// Signs at corners of which some faces look away: the corner of an L is where a face's own normal fails.
TEST(ClosedModel, SignsAreThoseOfTheSolid) {
    const ClosedModel model(test::angleModel(), "angle");
    test::Numbers random(2);
    for (int n = 0; n < 20000; ++n) {
        const glm::dvec3 p(30 * random() - 5, 20 * random() - 4, 14 * random() - 3);
        const bool inside =
            p.z > 0 && p.z < 8 &&
            ((p.x > 0 && p.x < 20 && p.y > 0 && p.y < 5) || (p.x > 0 && p.x < 6 && p.y > 0 && p.y < 12));
        ASSERT_EQ(model.distance(p).distance < 0, inside) << p.x << ' ' << p.y << ' ' << p.z;
    }
}

// A wedge whose sharp edge has a corner more above than below: a triangle without area lies between.
TriangleMesh wedge() {
    TriangleMesh mesh;
    mesh.points = {{0, 0, 0}, {0, 0, 4}, {0, 0, 10}, {10, 1, 0}, {10, 1, 10}, {10, -1, 0}, {10, -1, 10}};
    mesh.triangles = {{0, 1, 3}, {1, 4, 3}, {1, 2, 4}, {0, 5, 2}, {5, 6, 2},
                      {0, 2, 1}, {3, 4, 6}, {3, 6, 5}, {0, 3, 5}, {2, 6, 4}};
    return mesh;
}

TEST(ClosedModel, SignsBesideATriangleWithoutArea) {
    // The triangles' order decides which of equally near ones is found.
    for (std::size_t turned = 0; turned < 10; ++turned) {
        TriangleMesh mesh = wedge();
        std::rotate(mesh.triangles.begin(), mesh.triangles.begin() + static_cast<std::ptrdiff_t>(turned),
                    mesh.triangles.end());
        const ClosedModel model(std::move(mesh), "wedge");
        test::Numbers random(7);
        for (int n = 0; n < 20000; ++n) {
            glm::dvec3 p(9 * random() - 4, 4 * random() - 2, 12 * random() - 1);
            if (n % 10 == 0) p.z = 4;
            const bool inside = p.z > 0 && p.z < 10 && std::abs(p.y) < 0.1 * p.x;
            ASSERT_EQ(model.distance(p).distance < 0, inside) << p.x << ' ' << p.y << ' ' << p.z;
        }
        EXPECT_NEAR(model.volume(), 100, 1e-9);
    }
}

TEST(ClosedModel, CountsTrianglesThatAreThereTwice) {
    TriangleMesh mesh = wedge();
    EXPECT_EQ(ClosedModel(mesh, "wedge").repeated(), 0U);
    const std::vector<Triangle> once = mesh.triangles;
    for (Triangle t : once) {
        std::rotate(t.begin(), t.begin() + 1, t.end());
        mesh.triangles.push_back(t);
    }
    EXPECT_EQ(ClosedModel(mesh, "wedges").repeated(), once.size());
}

// The tree against all triangles.
TEST(ClosedModel, TheTreeFindsTheNearestOfAll) {
    const ClosedModel model(test::ellipsoidModel({5, 3, 2}, 12), "ellipsoid");
    test::Numbers random(3);
    for (int n = 0; n < 2000; ++n) {
        const glm::dvec3 p(14 * random() - 7, 14 * random() - 7, 14 * random() - 7);
        double least = 1e300;
        for (const Triangle& t : model.mesh().triangles)
            least = std::min(
                least, nearestOn(p, model.mesh().corner(t, 0), model.mesh().corner(t, 1), model.mesh().corner(t, 2))
                           .distance2);
        ASSERT_EQ(std::abs(model.distance(p).distance), std::sqrt(least));
    }
}

// Beside a fine grid of points of the triangle.
TEST(NearestOn, IsTheNearestPointOfTheTriangle) {
    test::Numbers random(4);
    const auto point = [&random] { return glm::dvec3(random(), random(), random()); };
    for (int n = 0; n < 200; ++n) {
        const glm::dvec3 a = point();
        const glm::dvec3 b = point();
        const glm::dvec3 c = n % 10 == 0 ? 0.3 * a + 0.7 * b : point();  // also without area
        const glm::dvec3 p = 3.0 * point() - 1.0;
        const double found = std::sqrt(nearestOn(p, a, b, c).distance2);
        double least = 1e300;
        constexpr int kSteps = 100;
        for (int i = 0; i <= kSteps; ++i)
            for (int j = 0; i + j <= kSteps; ++j) {
                const glm::dvec3 q = a + (b - a) * (1.0 * i / kSteps) + (c - a) * (1.0 * j / kSteps);
                least = std::min(least, glm::length(p - q));
            }
        ASSERT_LE(found, least + 1e-12);
        ASSERT_GE(found, least - 0.02);
    }
}

std::string refusalOf(TriangleMesh mesh) {
    return test::messageOf<InputError>([&] { const ClosedModel model(std::move(mesh), "part.stl"); });
}

TEST(ClosedModel, OpenAndInsideOutOnesAreRefused) {
    TriangleMesh open = test::boxModel({0, 0, 0}, {1, 1, 1});
    open.triangles.pop_back();
    EXPECT_NE(refusalOf(open).find("is not closed: 3 edges"), std::string::npos);
    EXPECT_NE(refusalOf(open).find("mm; repair"), std::string::npos);
    TriangleMesh turned = test::boxModel({0, 0, 0}, {1, 1, 1});
    for (Triangle& t : turned.triangles) std::swap(t[0], t[1]);
    EXPECT_NE(refusalOf(turned).find("inside out"), std::string::npos);
    TriangleMesh one_face_turned = test::boxModel({0, 0, 0}, {1, 1, 1});
    std::swap(one_face_turned.triangles[0][0], one_face_turned.triangles[0][1]);
    EXPECT_NE(refusalOf(one_face_turned).find("is not closed"), std::string::npos);
    EXPECT_EQ(refusalOf(test::boxModel({0, 0, 0}, {1, 1, 1})), "");
}

// Beyond the distance that is given a hundredth farther will do, and nothing else changes.
TEST(TriangleTree, RoughAnswersAreNearlyTheNearest) {
    const TriangleMesh mesh = test::ellipsoidModel({10, 9, 0.5}, 60);
    const TriangleTree tree(mesh);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(-60, 60);
    for (int n = 0; n < 2000; ++n) {
        const glm::dvec3 p(place(random), place(random), place(random));
        const double exact = std::sqrt(tree.nearest(p).distance2);
        const double rough = std::sqrt(tree.nearest(p, Nearest::kNone, 12).distance2);
        if (exact <= 12) {
            ASSERT_EQ(rough, exact);
        } else {
            ASSERT_LE(rough, exact / 0.99);
        }
        ASSERT_GE(rough, exact);
    }
}

}  // namespace
}  // namespace stratum::compare
