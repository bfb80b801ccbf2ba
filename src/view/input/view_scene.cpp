#include "view/input/view_scene.h"

#include "base/stopwatch.h"
#include "shade/palette/filament_color.h"
#include "voxelize/beads/placement.h"
#include "voxelize/beads/selection.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace stratum::view {
namespace {

using Json = nlohmann::json;

// Studio and sky without numbers stand beside the camera.
bool turnsWithCamera(const std::string& env) { return env == "studio" || env == "sky"; }

bool selectsLayers(const assemble::PrintRequest& prints) {
    return !prints.print.layers.empty() || !prints.printed.empty();
}

/// Heights of the layers first to last, mm: between the undersides of the lowest and the middle of the highest beads,
/// so that a flat cut shows the beads of the last layer.
struct Slab {
    double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
};

Slab slabOf(const gcode::Toolpath& toolpath, std::uint32_t first, std::uint32_t last) {
    Slab slab;
    for (const gcode::Bead& bead : toolpath.beads) {
        const gcode::Run& run = toolpath.runOf(bead);
        if (run.layer < first || run.layer > last) continue;
        const double top = std::max<double>(bead.z0, bead.z1);
        const auto height = static_cast<double>(run.height);
        slab.low = std::min(slab.low, std::min<double>(bead.z0, bead.z1) - height);
        slab.high = std::max(slab.high, top - 0.5 * height);
    }
    return slab;
}

// The layer that is being printed when that share is, as --printed has it.
std::uint32_t layerAt(const gcode::Toolpath& toolpath, double percent, bool by_time) {
    const auto moments = voxelize::parseSnapshots(fmt::format("{}{}%", by_time ? "time:" : "", percent), toolpath);
    const std::size_t beads = moments.empty() ? 1 : moments.front().bead_count;
    return toolpath.runOf(toolpath.beads[beads - 1]).layer;
}

Json legendJson(const shade::Legend& legend) {
    Json json{{"title", legend.title}, {"unit", legend.unit}, {"entries", Json::array()}, {"ramp", Json::array()}};
    for (const auto& entry : legend.entries)
        json["entries"].push_back({{"name", entry.name}, {"color", shade::hexOf(entry.color)}});
    for (const shade::Color& color : legend.ramp) json["ramp"].push_back(shade::hexOf(color));
    json["least"] = legend.least;
    json["most"] = legend.most;
    return json;
}

}  // namespace

bool ViewScene::has(const PicturePlan& plan) const {
    return objects_ && objects_->key == plan.objects_key && objects_->generation == document_.generation();
}

bool ViewScene::canStandIn(const PicturePlan& plan) const {
    return whole_ && whole_->generation == document_.generation() && selectsLayers(plan.options.tracing.prints) &&
           document_.given().objects.size() == 1 && document_.toolpath(0) != nullptr;
}

void ViewScene::makeObjects(const PicturePlan& plan, const assemble::ReadEvents& events) {
    if (has(plan)) return;
    Stopwatch watch;
    assemble::TracingOptions tracing =
        assemble::tracingFor(plan.options.scene, plan.options.render, plan.options.tracing);
    tracing.prints.kept = &document_.kept();
    tracing.prints.outline = true;  // the same objects may be shown in a named view later
    tracing.events = events;
    const bool whole = !selectsLayers(tracing.prints);
    // What is not needed any more makes room first.
    if (objects_ && objects_ != whole_) {
        staged_ = nullptr;
        objects_ = whole_;
    }
    auto made = std::make_shared<Objects>();
    std::vector<assemble::ObjectOptions> objects = document_.given().objects;
    if (!plan.own_materials)
        for (assemble::ObjectOptions& object : objects) object.material = {};
    made->traced = assemble::readTracedObjects(objects, tracing);
    made->key = plan.objects_key;
    made->generation = document_.generation();
    objects_ = std::move(made);
    if (whole) whole_ = objects_;
    staged_ = nullptr;
    build_seconds_ = watch.lap();
}

void ViewScene::forget() {
    objects_.reset();
    whole_.reset();
    stage_.reset();
    bare_light_.reset();
    staged_ = nullptr;
}

ViewedPicture ViewScene::picture(const PicturePlan& plan, int width, int height, Light light) {
    if (!objects_->bed_height && plan.options.scene.bed)
        objects_->bed_height = shade::restingHeight(*objects_->traced.intersector);
    return stage(*objects_, plan, objects_->traced.intersector, objects_->bed_height, width, height, light);
}

const shade::BareLight& ViewScene::bareLight() {
    if (!bare_light_) bare_light_ = std::make_shared<const shade::BareLight>(stage_->scene, stage_->middle);
    return *bare_light_;
}

ViewedPicture ViewScene::standIn(const PicturePlan& plan, const ViewState& state, int width, int height) {
    const auto toolpath = document_.toolpath(0);
    std::uint32_t first = std::max(1U, state.first_layer);
    std::uint32_t last = state.last_layer == 0 ? toolpath->layer_count : state.last_layer;
    if (state.printed) last = std::min(last, layerAt(*toolpath, *state.printed, state.by_time));
    first = std::min(first, last);
    const Slab slab = slabOf(*toolpath, first, last);
    std::vector<trace::ClipPlane> planes;
    std::optional<double> bed = whole_->bed_height;
    const voxelize::Placement lies = voxelize::placementOf(*toolpath);
    const auto [x, y, z] = voxelize::worldOf({0.0, 0.0, 1.0}, lies);
    const glm::dvec3 up(x, y, z);  // across the layers
    if (std::isfinite(slab.high)) planes.push_back({up, slab.high});
    if (first > 1 && std::isfinite(slab.low)) {
        planes.push_back({-up, -slab.low});
        if (lies.tilt == 0) bed = slab.low;
    }
    if (!bed && plan.options.scene.bed) bed = whole_->bed_height = shade::restingHeight(*whole_->traced.intersector);
    return stage(*whole_, plan, trace::makeClipIntersector(whole_->traced.intersector, std::move(planes)), bed, width,
                 height, Light::near);
}

bool ViewScene::lightFits(const shade::Camera& camera, const std::string& env, Light light) const {
    const shade::Camera& staged = stage_->scene.camera;
    if (staged_bed_ && (camera.eye().z > *staged_bed_) != (staged.eye().z > *staged_bed_)) return false;
    if (!turnsWithCamera(env)) return true;
    if (light == Light::exact) return camera.right() == staged.right();
    const double kNear = std::cos(12.0 * std::numbers::pi / 180.0);
    return glm::dot(camera.right(), staged.right()) > kNear;
}

ViewedPicture ViewScene::stage(Objects& objects, const PicturePlan& plan,
                               std::shared_ptr<const trace::Intersector> print, std::optional<double> bed_height,
                               int width, int height, Light light) {
    assemble::StageOptions options = plan.options;
    options.render.width = width;
    options.render.height = height;
    options.scene.bed_height = bed_height;
    if (staged_ == &objects && light_key_ == plan.light_key && staged_bed_ == bed_height) {
        const trace::Box box = options.frame_all ? print->bounds() : objects.traced.part.value_or(print->bounds());
        shade::CameraOptions camera = options.scene.camera;
        camera.mm_per_unit = objects.traced.mm_per_unit;
        const shade::Camera moved = shade::Camera::make(
            camera, box, width, height,
            options.frame_all ? std::span<const glm::dvec3>{} : std::span<const glm::dvec3>(objects.traced.outline));
        if (lightFits(moved, options.scene.env, light)) {
            ViewedPicture picture = staged(std::move(print), plan, light);
            picture.scene.camera = moved;
            return picture;
        }
    }
    assemble::TracedObjects seen = objects.traced;
    seen.intersector = print;
    stage_ = assemble::makeStage(seen, options);
    staged_ = &objects;
    light_key_ = plan.light_key;
    staged_bed_ = bed_height;
    bare_light_.reset();
    return staged(std::move(print), plan, light);
}

ViewedPicture ViewScene::staged(std::shared_ptr<const trace::Intersector> print, const PicturePlan& plan, Light light) {
    if (light == Light::near) bareLight();
    return {std::move(print), stage_->scene, {stage_->exposure.value_or(plan.exposure.value_or(0.0))}, bare_light_};
}

Json ViewScene::describe() const {
    Json json{{"legends", Json::array()}, {"warnings", Json::array()}};
    for (const shade::Legend& legend : objects().legends) json["legends"].push_back(legendJson(legend));
    constexpr std::size_t kMostWarnings = 50;
    for (const assemble::Warning& warning : objects().warnings)
        if (json["warnings"].size() < kMostWarnings) json["warnings"].push_back(warning.text);
    const trace::Box box = objects().part.value_or(objects().intersector->bounds());
    json["box"] = {box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z};
    json["mm_per_unit"] = objects().mm_per_unit;
    return json;
}

}  // namespace stratum::view
