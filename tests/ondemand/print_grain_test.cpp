// The direction in which beads were laid, at hits.
#include "march/attribute/annotation.h"
#include "march/brick/brick_intersector.h"
#include "ondemand/print_attributes.h"
#include "toolpaths.h"
#include "trace/clip_intersector.h"
#include "trace/scene_intersector.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <cmath>
#include <numbers>

namespace stratum::ondemand {
namespace {

// A straight bead along (3, 4) and an arc about (20, 0), both level, their tops at 0.2 mm.
std::shared_ptr<const PrintField> lineAndArc(const voxelize::Placement& placement) {
    auto toolpath = std::make_shared<gcode::Toolpath>();
    test::addBead(*toolpath, 0, 0, 0.2, 6, 8, 0.2, 0.5, 0.2);
    test::addArc(*toolpath, 20, 0, 5, 0, std::numbers::pi, 0.2, 0.2, 0.5, 0.2);
    const auto selection = test::allBeads(*toolpath);
    const auto lattice =
        voxelize::chooseLattice(*toolpath, selection, voxelize::boundsOf(*toolpath, selection), {0.05, std::nullopt});
    return std::make_shared<const PrintField>(toolpath, selection, lattice, placement, "two");
}

// Without a sign: a line forward and back is one.
double between(const glm::dvec3& a, const glm::dvec3& b) {
    return std::acos(std::min(std::abs(glm::dot(glm::normalize(a), glm::normalize(b))), 1.0));
}

TEST(PrintGrain, IsTheTangentOfTheBead) {
    const auto source = makePrintGrain(lineAndArc({}));
    const auto grain = source->makeLookup();
    const auto line = grain->at({3, 4, 0.2});
    ASSERT_TRUE(line);
    EXPECT_LT(between(*line, {0.6, 0.8, 0}), 1e-6);
    for (int degree = 10; degree < 180; degree += 10) {
        const double a = degree * std::numbers::pi / 180;
        const auto arc = grain->at({20 + 5 * std::cos(a), 5 * std::sin(a), 0.2});
        ASSERT_TRUE(arc) << degree;
        EXPECT_NEAR(static_cast<double>(glm::length(*arc)), 1, 1e-6);
        EXPECT_LT(between(*arc, {-std::sin(a), std::cos(a), 0}), 1e-3) << degree;
    }
    EXPECT_FALSE(grain->at({3, -4, 0.2}));
}

TEST(PrintGrain, IsInWorldSpace) {
    voxelize::Placement placement;
    placement.unit = 0.1;
    placement.offset[0] = 5;
    placement.up_y = true;
    const auto source = makePrintGrain(lineAndArc(placement));
    const auto grain = source->makeLookup();
    const auto line = grain->at({0.8, 0.02, -0.4});
    ASSERT_TRUE(line);
    EXPECT_LT(between(*line, {0.6, 0, -0.8}), 1e-6);
}

TEST(PrintGrain, TurnsWithTheObjectAndEndsAtCuts) {
    const auto field = lineAndArc({});
    march::Annotation annotation;
    annotation.grain = makePrintGrain(field);
    EXPECT_FALSE(annotation.empty());
    const auto shape = march::annotate(march::makeTracedBricks(field).intersector, annotation);
    // A quarter turn about z, stretched twofold along the print's own x: (3, 4) becomes (-4, 6).
    const auto placed =
        trace::makeSceneIntersector({{shape, trace::Placement::of({2, 1, 1}, {0, 0, 90}, {100, 0, 0})}});
    const trace::Ray down{{96, 6, 5}, {0, 0, -1}};
    trace::Hit hit;
    auto tracer = placed->makeTracer();
    ASSERT_TRUE(tracer->intersect(down, hit));
    EXPECT_LT(between(tracer->grain(hit), {-4, 6, 0}), 1e-6);
    EXPECT_NEAR(glm::length(tracer->grain(hit)), 1, 1e-6);

    const auto cut = trace::makeClipIntersector(placed, {{{0, 0, 1}, 0.1}});
    tracer = cut->makeTracer();
    ASSERT_TRUE(tracer->intersect(down, hit));
    EXPECT_NEAR(hit.position.z, 0.1, 1e-9);
    EXPECT_EQ(tracer->grain(hit), glm::dvec3(0.0));
}

TEST(PrintGrain, ShapesWithoutBeadsHaveNone) {
    const auto shape = march::makeTracedBricks(lineAndArc({})).intersector;
    auto tracer = shape->makeTracer();
    trace::Hit hit;
    ASSERT_TRUE(tracer->intersect({{3, 4, 5}, {0, 0, -1}}, hit));
    EXPECT_EQ(tracer->grain(hit), glm::dvec3(0.0));
}

}  // namespace
}  // namespace stratum::ondemand
