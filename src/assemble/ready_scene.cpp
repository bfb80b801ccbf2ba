#include "assemble/ready_scene.h"

#include "shade/post/exposure.h"
#include "shade/scene/paper_tone.h"

#include <glm/geometric.hpp>

#include <utility>

namespace stratum::assemble {
namespace {

// Along its view it leaves what it meets first.
bool isInside(const shade::Camera& camera, const trace::Intersector& objects) {
    trace::Ray ray;
    ray.origin = camera.eye();
    ray.direction = camera.forward();
    trace::Hit hit;
    return objects.makeTracer()->intersect(ray, hit) && glm::dot(hit.normal, ray.direction) > 0;
}

}  // namespace

Stage makeStage(const TracedObjects& objects, const StageOptions& options, const ReadEvents& events) {
    const bool needs_light = shade::needsLight(options.render.integrator);
    shade::SceneOptions seen = options.scene;
    seen.mm_per_unit = objects.mm_per_unit;
    seen.brdf = objects.brdf;
    if (!options.frame_all) {
        seen.frame = objects.part;
        seen.outline = objects.outline;
    }
    if (seen.transparent && !shade::followsPaths(options.render.integrator)) seen.bed = false;
    // An integrator without light needs no environment.
    if (!needs_light && seen.env == "studio") seen.env = "constant:0,0,0";
    Stage stage = [&] {
        const Step step(events, "preparing");
        return Stage{shade::makeScene(seen, *objects.intersector, options.render.width, options.render.height),
                     glm::dvec3(0.0), std::nullopt};
    }();
    if (seen.camera.eye && events.warning && isInside(stage.scene.camera, *objects.intersector))
        events.warning({Warning::Kind::camera,
                        "the camera is inside the plastic and sees it from within; move --eye, or cut it open with "
                        "--clip"});
    stage.scene.objects = objects.materials;
    stage.scene.labels = objects.labels;
    shade::matchPaper(stage.scene, seen.bed_surface);
    const trace::Box box = seen.frame.value_or(objects.intersector->bounds());
    stage.middle = 0.5 * (box.min + box.max);
    const bool studio = seen.env == "studio" && seen.lights.empty();  // bright enough as it is
    if (options.find_exposure && !studio && needs_light)
        stage.exposure = shade::automaticExposure(stage.scene, stage.middle);
    return stage;
}

shade::PixelSpread pixelSpreadOf(const StageOptions& options, const voxelize::Bounds& print,
                                 const voxelize::Bounds& part, std::span<const glm::dvec3> outline,
                                 const shade::Camera* camera, int turns) {
    const trace::Box box = boxOf(print);
    if (camera != nullptr) return shade::pixelSpread(*camera, box, turns);
    const shade::Camera framed =
        options.frame_all ? shade::Camera::make(options.scene.camera, box, options.render.width, options.render.height)
                          : shade::Camera::make(options.scene.camera, boxOf(part), options.render.width,
                                                options.render.height, outline);
    return shade::pixelSpread(framed, box, turns);
}

ReadyScene readyScene(const std::vector<ObjectOptions>& objects, const PictureOptions& options) {
    options.render.validate();
    options.scene.camera.validate();
    TracingOptions tracing = tracingFor(options.scene, options.render, options.tracing);
    if (!tracing.prints.pixel_spread && objects.size() == 1 && objects.front().placement.isIdentity())
        tracing.prints.pixel_spread = [&](const voxelize::Bounds& print, const voxelize::Bounds& part,
                                          std::span<const glm::dvec3> outline) {
            return pixelSpreadOf(options, print, part, outline);
        };
    TracedObjects read = readTracedObjects(objects, tracing);
    Stage stage = makeStage(read, options, tracing.events);
    return {std::move(read), std::move(stage.scene), shade::ToneOptions{stage.exposure.value_or(0.0)}, stage.middle};
}

ReadyScene readyScene(const std::string& path, const PictureOptions& options) {
    return readyScene(std::vector<ObjectOptions>{{.vdb = path}}, options);
}

}  // namespace stratum::assemble
