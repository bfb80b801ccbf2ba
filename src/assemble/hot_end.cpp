#include "assemble/hot_end.h"

#include "assemble/print/lazy_print.h"
#include "base/error.h"
#include "shade/brdf/brdf.h"
#include "trace/convex_solid.h"
#include "trace/scene_intersector.h"

#include <string_view>
#include <utility>
#include <vector>

namespace stratum::assemble {
namespace {

// Reflectances at normal incidence: brass, aluminium and iron as in "Physically Based" (physicallybased.info, 2023).
constexpr std::string_view kBrass = "metal:0.91,0.78,0.42,0.25";
constexpr std::string_view kAluminium = "metal:0.91,0.92,0.92,0.35";
constexpr std::string_view kSteel = "metal:0.53,0.51,0.49,0.3";

struct Part {
    std::shared_ptr<const trace::Intersector> solid;
    std::string_view metal;
};

// In mm above the tip.
std::vector<Part> makeParts() {
    return {{trace::makeConeSolid(0, 0.5, 3, 3.0), kBrass},
            {trace::makeHexagonSolid(7, 3, 6), kBrass},
            {trace::makeBoxSolid({-6, -6, 6}, {9, 6, 14}), kSteel},
            {trace::makeConeSolid(14, 1.6, 17, 1.6), kSteel},
            {trace::makeConeSolid(17, 5, 27, 5), kAluminium}};
}

}  // namespace

HotEnd::HotEnd(const TracedObjects& objects, shade::SceneDescription& scene) : print_(objects.intersector) {
    if (objects.prints.empty())
        throw UsageError("--nozzle needs G-code: a level set doesn't know where its last bead ends");
    layers_ = objects.prints.front();
    if (scene.objects.empty()) scene.objects.emplace_back(scene.material);
    for (const Part& part : makeParts()) scene.objects.emplace_back(shade::makeBrdf(part.metal));
}

std::shared_ptr<const trace::Intersector> HotEnd::at(std::size_t moment) const {
    return withHotEnd(print_, layers_->tipAt(moment));
}

std::shared_ptr<const trace::Intersector> withHotEnd(const std::shared_ptr<const trace::Intersector>& print,
                                                     const glm::dvec3& tip) {
    std::vector<trace::SceneObject> objects{{print, {}}};
    for (Part& part : makeParts()) objects.push_back({std::move(part.solid), {glm::dmat3(1.0), tip}});
    return trace::makeSceneIntersector(std::move(objects));
}

}  // namespace stratum::assemble
