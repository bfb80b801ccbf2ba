#include "compare/best_fit.h"

#include "shapes.h"

#include "base/error.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::compare {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

double worstCorner(const TriangleMesh& mesh, const Rigid& a, const Rigid& b) {
    double worst = 0;
    for (const glm::dvec3& p : mesh.points) worst = std::max(worst, glm::length(a(p) - b(p)));
    return worst;
}

TEST(Rigid, TurnsBackAndTellsItsAngle) {
    const Rigid by{turnBy({0.1, -0.7, 0.4}), {1, 2, 3}};
    const glm::dvec3 p(4, -5, 6);
    EXPECT_LT(glm::length(by.inverse()(by(p)) - p), 1e-12);
    EXPECT_LT(glm::length(by.after(by)(p) - by(by(p))), 1e-12);
    for (const double angle : {0.0, 1e-9, 1.0, 3.0, std::numbers::pi})
        EXPECT_NEAR(angleOf(turnBy(glm::normalize(glm::dvec3(1, 2, 3)) * angle)), angle, 1e-7);
}

TEST(FitModel, FindsAnyTurnAboutZ) {
    const ClosedModel model(test::angleModel(), "angle");
    for (int degree = 0; degree < 360; degree += 37) {
        const Rigid by{turnBy({0, 0, degree * kDegree}), {100, 80, -3}};
        const Fit fit = fitModel(model, sampleSurface(test::moved(test::angleModel(), by), 30000));
        EXPECT_LT(worstCorner(model.mesh(), fit.model_to_print, by), 1e-3) << degree;
        EXPECT_LT(fit.residual, 1e-3);
    }
}

TEST(FitModel, FindsItOnAnotherSide) {
    const ClosedModel model(test::angleModel(), "angle");
    for (const glm::dvec3& axis :
         {glm::dvec3(1, 0, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(2, 0, 0)}) {
        const Rigid by{turnBy({0, 0, 1.1}) * turnBy(axis * (90 * kDegree)), {5, 6, 7}};
        const Fit fit = fitModel(model, sampleSurface(test::moved(test::angleModel(), by), 30000));
        EXPECT_LT(worstCorner(model.mesh(), fit.model_to_print, by), 1e-3) << axis.x << axis.y;
    }
}

// A print is rough, and has what the model has not: a tenth of the samples may be anywhere.
TEST(FitModel, IsNotMovedByRoughnessAndStrangers) {
    const TriangleMesh angle = test::angleModel();
    const ClosedModel model(test::angleModel(), "angle");
    const Rigid by{turnBy({0.01, -0.02, 0.5}), {10, 20, 0}};
    SurfaceSamples samples = sampleSurface(angle, 30000);
    test::Numbers random(5);
    for (std::size_t n = 0; n < samples.points.size(); ++n) {
        const Triangle& t = angle.triangles[samples.triangles[n]];
        samples.points[n] = by(samples.points[n] + glm::normalize(angle.areaNormal(t)) * (0.1 * random() - 0.05));
        if (n % 13 == 0) samples.points[n] += glm::dvec3(3 * random(), 3 * random(), 2 + random());
    }
    const Fit fit = fitModel(model, samples);
    EXPECT_LT(worstCorner(model.mesh(), fit.model_to_print, by), 0.02);
    EXPECT_NEAR(fit.residual, 0.1 / std::sqrt(12), 0.01);
}

// Of placements that are alike, the one with the smallest turn; and what nothing determines stays as it is.
TEST(FitModel, SymmetricModelsTurnAsLittleAsMayBe) {
    const TriangleMesh cube = test::boxModel({0, 0, 0}, {10, 10, 10});
    const ClosedModel of_cube(test::boxModel({0, 0, 0}, {10, 10, 10}), "cube");
    const Rigid little{turnBy({0, 0, 10 * kDegree}), {50, 50, 0}};
    const Fit cube_fit = fitModel(of_cube, sampleSurface(test::moved(cube, little), 30000));
    EXPECT_LT(worstCorner(cube, cube_fit.model_to_print, little), 1e-3);
    const TriangleMesh sphere = test::ellipsoidModel({5, 5, 5}, 40);
    const ClosedModel of_sphere(test::ellipsoidModel({5, 5, 5}, 40), "sphere");
    const Fit sphere_fit = fitModel(of_sphere, sampleSurface(test::moved(sphere, little), 30000));
    EXPECT_LT(glm::length(sphere_fit.model_to_print({0, 0, 0}) - glm::dvec3(50, 50, 0)), 1e-3);
    EXPECT_LT(sphere_fit.residual, 0.01);
}

TEST(FitModel, TooFewSamplesAreRefused) {
    const ClosedModel model(test::angleModel(), "angle");
    EXPECT_THROW(fitModel(model, sampleSurface(model.mesh(), 99)), UsageError);
}

TEST(SurfaceSamples, AreEvenOverTheArea) {
    const TriangleMesh box = test::boxModel({0, 0, 0}, {4, 2, 1});
    const SurfaceSamples samples = sampleSurface(box, 28000);
    EXPECT_NEAR(samples.area, 28, 1e-12);
    std::size_t top = 0;
    std::size_t corner = 0;
    for (const glm::dvec3& p : samples.points) {
        if (p.z < 1 - 1e-9) continue;
        ++top;
        corner += p.x < 1 && p.y < 1 ? 1 : 0;
    }
    EXPECT_NEAR(static_cast<double>(top), 8000, 20);
    EXPECT_NEAR(static_cast<double>(corner), 1000, 50);
}

}  // namespace
}  // namespace stratum::compare
