#include "view/inspect.h"

#include "ondemand/bead_lookup.h"
#include "voxelize/beads/placement.h"

#include <glm/matrix.hpp>

#include <cmath>
#include <optional>

namespace stratum::view {
namespace {

using Json = nlohmann::json;

Json list(const glm::dvec3& v) { return Json::array({v.x, v.y, v.z}); }

Json describe(const gcode::Toolpath& toolpath, std::uint32_t index) {
    const gcode::Bead& bead = toolpath.beads[index];
    const gcode::Run& run = toolpath.runOf(bead);
    const voxelize::Placement lies = voxelize::placementOf(toolpath);
    Json json{{"number", index},
              {"layer", run.layer},
              {"feature", gcode::featureName(run.feature)},
              {"tool", run.tool},
              {"width_mm", bead.width},
              {"height_mm", run.height},
              {"length_mm", gcode::beadLength(toolpath, bead)},
              {"volume_mm3", gcode::laidVolume(toolpath, index)},
              {"feed_rate_mm_s", run.speed},
              {"from", voxelize::worldOf({bead.x0, bead.y0, bead.z0}, lies)},
              {"to", voxelize::worldOf({bead.x1, bead.y1, bead.z1}, lies)},
              {"line", toolpath.lineOf(bead)}};
    if (run.object != 0) json["object"] = toolpath.objects[run.object].substr(0, 200);
    if (!toolpath.timing.empty()) {
        const gcode::BeadTiming& timing = toolpath.timing[index];
        json["time_s"] = timing.start;
        json["seconds"] = timing.seconds;
        if (timing.seconds > 0.0f)
            json["speed_mm_s"] = gcode::beadLength(toolpath, bead) / static_cast<double>(timing.seconds);
    }
    return json;
}

// The bead at a place of an object, which is a print in the space of its file.
std::optional<std::uint32_t> beadAt(const assemble::TracedObjects& objects, const assemble::ObjectOptions& object,
                                    const trace::Hit& hit) {
    if (objects.prints.empty()) return std::nullopt;
    const glm::dvec3 own = glm::inverse(object.placement.linear) * (hit.position - object.placement.offset);
    // Prints stand in the order of their first objects; those of one file share theirs.
    for (const auto& print : objects.prints) {
        const ondemand::PrintField& field = print->finest();
        if (field.name() != object.vdb) continue;
        ondemand::BeadLookup lookup(field);
        return lookup.at(own);
    }
    return std::nullopt;
}

}  // namespace

Json inspect(Document& document, const ViewScene& scene, const ViewedPicture& picture, const glm::dvec2& pixel) {
    const trace::Ray ray = picture.scene.camera.ray(pixel);
    trace::Hit hit;
    if (!picture.print->makeTracer()->intersect(ray, hit)) return {{"hit", false}};
    // The bed hides what is below it.
    if (picture.scene.bed && ray.direction.z < 0.0 &&
        (picture.scene.bed->z - ray.origin.z) / ray.direction.z < hit.t - 1e-9 * std::abs(hit.t))
        return {{"hit", false}};
    Json json{{"hit", true}, {"position", list(hit.position)}, {"normal", list(hit.normal)}, {"distance", hit.t}};
    const auto& objects = document.given().objects;
    if (hit.object >= objects.size()) return json;
    const std::optional<std::uint32_t> bead = beadAt(scene.objects(), objects[hit.object], hit);
    if (!bead) return json;
    const auto toolpath = document.timedToolpath(hit.object);
    if (!toolpath || *bead >= toolpath->beads.size()) return json;
    json["bead"] = describe(*toolpath, *bead);
    json["lines"] = document.linesAround(hit.object, toolpath->lineOf(toolpath->beads[*bead]));
    return json;
}

}  // namespace stratum::view
