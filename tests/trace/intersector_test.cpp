#include "trace/intersector.h"

#include "intersector_contract.h"
#include "march/attribute/annotation.h"
#include "march/brick/brick_intersector.h"
#include "march/file/sdf_grid.h"
#include "march/reference/reference_intersectors.h"
#include "trace/clip_intersector.h"
#include "trace/convex_solid.h"
#include "trace/detail_intersector.h"
#include "trace/scene_intersector.h"
#include "trace/sdf.h"
#include "trace/sdf_intersector.h"

#include <algorithm>

namespace stratum::trace {
namespace {

using test::ContractCase;
using Shape = std::shared_ptr<const Intersector>;

const SdfPtr& torus() {
    static const SdfPtr shape = sdfTorus({0, 0, 0}, 3, 1, 2);
    return shape;
}

openvdb::FloatGrid::ConstPtr gridOf(double voxel) {
    openvdb::initialize();
    return march::makeSdfGrid(*torus(), voxel);
}

Shape bricks() { return march::makeBrickIntersector(*gridOf(0.1)); }

double toTorus(const glm::dvec3& p) { return torus()->distance(p); }

// A quarter of the torus and what is left below z = 0.3.
const std::vector<ClipPlane> kPlanes = {{{0, 0, 1}, 0.3}, {{1, 0.5, 0}, 0.4}, {{0, -1, 0.2}, 2.0}};

double toClippedTorus(const glm::dvec3& p) {
    double distance = toTorus(p);
    for (const ClipPlane& plane : kPlanes)
        distance = std::max(distance, (glm::dot(plane.normal, p) - plane.offset) / glm::length(plane.normal));
    return distance;
}

const Placement& beside() {
    static const Placement placement = Placement::of({0.5, 0.5, 0.5}, {20, 40, 10}, {7, 1, 0});
    return placement;
}

double toTwo(const glm::dvec3& p) {
    return std::min(toTorus(p), 0.5 * toTorus(glm::inverse(beside().linear) * (p - beside().offset)));
}

std::vector<ContractCase> cases() {
    // Trilinear interpolation of the torus' distance in cells of 0.1: 3/8 of the square over its smallest radius.
    constexpr double kSampled = 5e-3;
    const Shape formula = makeSdfIntersector(torus(), 1e-6);
    march::Annotation smooth;
    smooth.smooth = gridOf(0.1);
    const double pi = std::acos(-1.0);
    return {
        {"Formula", formula, toTorus, 1e-5},
        {"Box", makeBoxSolid({-1, -2, 0}, {1, 2, 3}),
         [](const glm::dvec3& p) {
             return sdfBox({0, 0, 1.5}, {1, 2, 1.5})->distance(p);
         },
         1e-9},
        {"Hexagon", makeHexagonSolid(4, -1, 1),
         [pi](const glm::dvec3& p) {
             double distance = std::abs(p.z) - 1;
             for (int n = 0; n < 3; ++n)
                 distance = std::max(distance, std::abs(p.x * std::cos(n * pi / 3) + p.y * std::sin(n * pi / 3)) - 2);
             return distance;
         },
         1e-9},
        {"Cone", makeConeSolid(-1, 2, 1, 1),
         [](const glm::dvec3& p) {
             const double side = (std::hypot(p.x, p.y) - 1.5 + 0.5 * p.z) / std::sqrt(1.25);
             return std::max(std::abs(p.z) - 1, side);
         },
         1e-9},
        {"Bricks", bricks(), toTorus, kSampled},
        {"FloatBricks", march::makeBrickIntersector(*gridOf(0.1), march::BrickValues::Float32), toTorus, kSampled},
        // Its last step ends at t_max, so the hit moves a little with that: one ray in twenty.
        {"SphereTracing", march::makeSphereIntersector(gridOf(0.1)), toTorus, kSampled, 0.06},
        {"OpenVdb", march::makeVdbIntersector(gridOf(0.1)), toTorus, kSampled},
        {"Annotated", march::annotate(bricks(), smooth), toTorus, kSampled},
        {"Scene", makeSceneIntersector({{bricks(), {}}, {formula, beside()}}), toTwo, kSampled},
        {"SceneOfOne", makeSceneIntersector({{formula, beside()}}),
         [](const glm::dvec3& p) { return 0.5 * toTorus(glm::inverse(beside().linear) * (p - beside().offset)); },
         1e-5},
        {"Details", makeDetailIntersector({{formula, 0}, {formula, 2}, {formula, 5}}, {1, 1, 1}), toTorus, 1e-5},
        {"DetailsOfTwoSizes",
         makeDetailIntersector({{bricks(), 0}, {march::makeBrickIntersector(*gridOf(0.2)), 4}}, {3, 0, 2}), toTorus,
         4 * kSampled, 2e-3},
        {"Clipped", makeClipIntersector(formula, kPlanes), toClippedTorus, 1e-5},
        {"ClippedBricks", makeClipIntersector(bricks(), kPlanes), toClippedTorus, kSampled},
        {"ClippedTwice", makeClipIntersector(makeClipIntersector(formula, {kPlanes[0]}), {kPlanes[1], kPlanes[2]}),
         toClippedTorus, 1e-5},
        {"ClippedDetails", makeClipIntersector(makeDetailIntersector({{formula, 0}, {formula, 4}}, {1, 1, 1}), kPlanes),
         toClippedTorus, 1e-5},
    };
}

class EveryIntersector : public testing::TestWithParam<ContractCase> {};

TEST_P(EveryIntersector, KeepsItsPromises) { test::expectContract(GetParam()); }

INSTANTIATE_TEST_SUITE_P(Cases, EveryIntersector, testing::ValuesIn(cases()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace stratum::trace
