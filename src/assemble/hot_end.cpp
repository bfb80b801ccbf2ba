#include "assemble/hot_end.h"

#include "shade/brdf/brdf.h"
#include "trace/scene_intersector.h"
#include "trace/sdf.h"
#include "trace/sdf_intersector.h"

#include <array>
#include <string_view>
#include <utility>

namespace stratum::assemble {
namespace {

using trace::SdfPtr;

constexpr int kUp = 2;  // the axis z

// All in mm above the tip.
SdfPtr nozzle() {
    std::vector<SdfPtr> sides;
    for (const double degrees : {0.0, 60.0, 120.0})
        sides.push_back(trace::sdfMoved(trace::sdfBox({0, 0, 0}, {3.5, 5.0, 1.5}),
                                        trace::Placement::of(glm::dvec3(1.0), {0, 0, degrees}, {}).linear,
                                        {0, 0, 3.5}));
    return trace::sdfUnion({trace::sdfCone({0, 0, 1}, 0.5, 2.5, 1.0, kUp), trace::sdfIntersection(std::move(sides)),
                            trace::sdfCylinder({0, 0, 5.5}, 3.0, 0.75, kUp)});
}

SdfPtr block() { return trace::sdfBox({3.5, 0, 11.5}, {11.5, 8.0, 5.75}); }

SdfPtr heatBreak() { return trace::sdfCylinder({0, 0, 18.5}, 1.5, 1.5, kUp); }

SdfPtr sink() {
    constexpr double kPitch = 2.5;
    constexpr int kFinsToEachSide = 5;
    const SdfPtr fins =
        trace::sdfRepetition(trace::sdfCylinder({0, 0, 0}, 11.0, 0.5, kUp), {0, 0, kPitch}, kFinsToEachSide);
    return trace::sdfUnion(
        {trace::sdfMoved(fins, glm::dmat3(1.0), {0, 0, 32.5}), trace::sdfCylinder({0, 0, 33.0}, 5.0, 14.0, kUp)});
}

// Reflectances at normal incidence: brass, aluminium and iron as in "Physically Based" (physicallybased.info, 2023).
constexpr std::array<std::string_view, 4> kMetals = {"metal:0.91,0.78,0.42,0.25", "metal:0.91,0.92,0.92,0.35",
                                                     "metal:0.53,0.51,0.49,0.3", "metal:0.91,0.92,0.92,0.3"};

}  // namespace

HotEnd::HotEnd() {
    constexpr double kTolerance = 1e-3;  // mm
    for (SdfPtr& shape : std::array<SdfPtr, kMetals.size()>{nozzle(), block(), heatBreak(), sink()})
        parts_.push_back(trace::makeSdfIntersector(std::move(shape), kTolerance));
}

std::shared_ptr<const trace::Intersector> HotEnd::above(const std::shared_ptr<const trace::Intersector>& print,
                                                        const glm::dvec3& tip) const {
    std::vector<trace::SceneObject> objects{{print, {}}};
    for (const auto& part : parts_) objects.push_back({part, {glm::dmat3(1.0), tip}});
    return trace::makeSceneIntersector(std::move(objects));
}

void HotEnd::addMaterials(shade::SceneDescription& scene) {
    if (scene.objects.empty()) scene.objects.emplace_back(scene.material);
    for (const std::string_view metal : kMetals) scene.objects.emplace_back(shade::makeBrdf(metal));
}

}  // namespace stratum::assemble
