#include "shade/scene.h"

#include "io/error.h"
#include "shade/sampling.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace stratum::shade {
namespace {

/// Radiance of the bare paper far from the print.
Color paperRadiance(const SceneDescription& scene, const Color& albedo, const glm::dvec3& point) {
    Color irradiance = irradianceFromAbove(*scene.environment) + kPi * scene.ambient;
    for (const auto& light : scene.lights) irradiance += irradianceFrom(*light, point);
    return albedo * irradiance * kInvPi;
}

}  // namespace

Label parseLabel(std::string_view text) {
    for (std::size_t n = 0; n < kLabels; ++n)
        if (labelName(static_cast<Label>(n)) == text) return static_cast<Label>(n);
    throw UsageError(fmt::format("{}: no label; choose layer, tool or feature", text));
}

std::string_view labelName(Label label) {
    constexpr std::array<std::string_view, kLabels> kNames = {"layer", "tool", "feature"};
    return kNames[static_cast<std::size_t>(label)];
}

double restingHeight(const march::Intersector& print) {
    constexpr int kSide = 128;
    const march::Box box = print.bounds();
    const glm::dvec3 size = box.max - box.min;
    const auto tracer = print.makeTracer();
    double lowest = std::numeric_limits<double>::infinity();
    march::Ray ray;
    ray.direction = {0.0, 0.0, 1.0};
    for (int i = 0; i < kSide; ++i) {
        for (int j = 0; j < kSide; ++j) {
            ray.origin = {box.min.x + size.x * (i + 0.5) / kSide, box.min.y + size.y * (j + 0.5) / kSide,
                          box.min.z - std::max(size.z, print.voxelSize())};
            march::Hit hit;
            if (tracer->intersect(ray, hit)) lowest = std::min(lowest, hit.position.z);
        }
    }
    return std::isfinite(lowest) ? std::clamp(lowest, box.min.z, box.max.z) : box.min.z;
}

SceneDescription makeScene(const SceneOptions& options, const march::Intersector& print, int width, int height) {
    const march::Box box = print.bounds();
    SceneDescription scene{.camera = Camera::make(options.camera, box, width, height),
                           .material = makeBrdf(options.brdf),
                           .objects = {},
                           .smooth_normals = options.smooth_normals,
                           .labels = {},
                           .environment = nullptr,
                           .lights = {},
                           .ambient = Color(0.0f),
                           .bed = std::nullopt,
                           .backdrop = std::nullopt};
    for (const std::string& light : options.lights) {
        if (const auto ambient = parseAmbient(light))
            scene.ambient += *ambient;
        else
            scene.lights.push_back(parseLight(light));
    }

    EnvironmentPlacement placement;
    placement.azimuth = std::atan2(scene.camera.right().y, scene.camera.right().x);
    placement.bed = false;
    placement.rotation = options.env_rotation * std::numbers::pi / 180.0;
    placement.exposure = options.env_exposure;
    Bed bed;
    if (options.bed) {
        bed.z = restingHeight(print);
        placement.bed = scene.camera.eye().z > bed.z;
    }
    scene.environment = makeEnvironment(options.env, placement);
    if (auto sun = scene.environment->sun()) scene.lights.push_back(std::move(sun));

    bed.centre = {0.5 * (box.min.x + box.max.x), 0.5 * (box.min.y + box.max.y)};
    const Color paper = paperRadiance(scene, bed.albedo, {bed.centre.x, bed.centre.y, bed.z});
    if (placement.bed) {
        const double reach = 0.5 * glm::length(box.max - box.min);
        bed.fade_begin = 1.0 * reach;
        bed.fade_end = 7.0 * reach;
        scene.bed = bed;
    }
    // The paper's own colour a little darker, as the light of a real lamp falls off behind the subject.
    if (options.backdrop && (scene.bed || !scene.environment->visible()))
        scene.backdrop = Backdrop{paper * 0.72f, paper * 0.35f};
    return scene;
}

}  // namespace stratum::shade
