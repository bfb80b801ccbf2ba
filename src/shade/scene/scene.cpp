#include "shade/scene/scene.h"

#include "base/error.h"
#include "base/parallel_for.h"
#include "shade/camera/sampling.h"
#include "shade/finish/named_brdf.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace stratum::shade {
namespace {

/// Radiance of the bare paper far from the print.
Color paperRadiance(const SceneDescription& scene, const Color& albedo, const glm::dvec3& point) {
    Color irradiance = scene.environment->irradianceFromAbove() + kPi * scene.ambient;
    for (const auto& light : scene.lights) irradiance += irradianceFrom(*light, point);
    return albedo * irradiance * kInvPi;
}

// The lowest surface that side x side rays from below meet, up to `reach` above the box's floor; infinite if none does.
double lowestSurface(const trace::Intersector& print, std::size_t side, double reach) {
    const trace::Box box = print.bounds();
    const glm::dvec3 size = box.max - box.min;
    const double below = std::max(size.z, print.voxelSize());
    const auto share = [side](std::size_t n) { return (static_cast<double>(n) + 0.5) / static_cast<double>(side); };
    std::vector<double> lowest_of(side, std::numeric_limits<double>::infinity());
    parallelFor(side, 1, [&](std::size_t first, std::size_t last) {
        const auto tracer = print.makeTracer();
        std::vector<trace::Ray> rays(side);
        std::vector<trace::Hit> hits(side);
        for (std::size_t i = first; i != last; ++i) {
            for (std::size_t j = 0; j < side; ++j) {
                rays[j].origin = {box.min.x + size.x * share(i), box.min.y + size.y * share(j), box.min.z - below};
                rays[j].direction = {0.0, 0.0, 1.0};
                rays[j].t_max = below + reach;
            }
            tracer->intersectStream(rays, hits);
            for (const trace::Hit& hit : hits)
                if (std::isfinite(hit.t)) lowest_of[i] = std::min(lowest_of[i], hit.position.z);
        }
    });
    return *std::min_element(lowest_of.begin(), lowest_of.end());
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

double restingHeight(const trace::Intersector& print) {
    constexpr std::size_t kSide = 128;
    constexpr std::size_t kFewSide = 32;
    // The floor of a level set's box is below its lowest surface by its narrow band, of three voxels unless asked for
    // otherwise, and a voxel at most.
    constexpr double kNear = 4;  // voxels
    const trace::Box box = print.bounds();
    const double height = box.max.z - box.min.z;
    // Increases the height in at most five steps, also for a voxel size of 0 (analytic shapes, triangles), and no
    // higher than necessary: leaves may be evaluated on demand, and a print that rests on the bed is hit in the first
    // step.
    double reach = std::max(8 * print.voxelSize(), height / 256);
    // Few rays will do if what they meet is as low as the box allows: each makes bricks that the camera does not see.
    const double low = lowestSurface(print, kFewSide, reach);
    if (low - box.min.z <= kNear * print.voxelSize()) return std::max(low, box.min.z);
    for (;; reach *= 4) {
        const bool whole = !(reach < height);
        const double lowest = lowestSurface(print, kSide, whole ? std::numeric_limits<double>::infinity() : reach);
        if (std::isfinite(lowest)) return std::clamp(lowest, box.min.z, box.max.z);
        if (whole) return box.min.z;
    }
}

bool SceneDescription::anyTranslucent() const {
    return material->translucent() != nullptr ||
           std::any_of(objects.begin(), objects.end(), [](const ObjectMaterial& m) { return m.anyTranslucent(); });
}

bool SceneDescription::anyByPlace() const {
    return material->variesByPlace() ||
           std::any_of(objects.begin(), objects.end(), [](const ObjectMaterial& m) { return m.anyByPlace(); });
}

SceneDescription makeScene(const SceneOptions& options, const trace::Intersector& print, int width, int height) {
    const trace::Box box = print.bounds();
    CameraOptions camera = options.camera;
    camera.mm_per_unit = options.mm_per_unit;
    SceneDescription scene{.camera = Camera::make(camera, options.frame.value_or(box), width, height, options.outline),
                           .material = makeBrdf(options.brdf),
                           .objects = {},
                           .smooth_normals = options.smooth_normals,
                           .labels = {},
                           .environment = nullptr,
                           .lights = {},
                           .ambient = Color(0.0f),
                           .bed = std::nullopt,
                           .backdrop = std::nullopt,
                           .transparent = options.transparent,
                           .catcher = std::nullopt,
                           .mm_per_unit = options.mm_per_unit};
    constexpr std::size_t kMostLights = 1024;
    if (options.lights.size() > kMostLights)
        throw UsageError(fmt::format("{} lights; each is asked at each point that is seen, so at most {} can be given",
                                     options.lights.size(), kMostLights));
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
        bed.texture = BedTexture(options.bed_surface, options.mm_per_unit);
        bed.z = options.bed_height ? *options.bed_height : restingHeight(print);
        placement.bed = scene.camera.eye().z > bed.z;
    }
    scene.environment = makeEnvironment(options.env, placement);
    if (auto sun = scene.environment->sun()) scene.lights.push_back(std::move(sun));

    const trace::Box subject = options.frame.value_or(box);
    const glm::dvec3 middle = 0.5 * (subject.min + subject.max);
    bed.center = {middle.x, middle.y};
    if (placement.bed) {
        // Up to the farthest corner of everything on the bed.
        const double reach = glm::length(glm::max(box.max - middle, middle - box.min));
        bed.fade_begin = 1.0 * reach;
        bed.fade_end = 7.0 * reach;
        scene.bed = bed;
    }
    if (options.transparent) {
        if (scene.bed)
            scene.catcher =
                ShadowCatcher{scene.environment->irradianceFromAbove() + kPi * scene.ambient,
                              luminance(paperRadiance(scene, bed.texture.mean(), {bed.center.x, bed.center.y, bed.z}))};
        return scene;
    }
    // The paper's own color a little darker, as the light of a real lamp falls off behind the subject.
    if (options.backdrop && (scene.bed || !scene.environment->visible())) {
        const Color paper = paperRadiance(scene, bed.texture.mean(), {bed.center.x, bed.center.y, bed.z});
        scene.backdrop = Backdrop{paper * 0.72f, paper * 0.35f};
    }
    return scene;
}

}  // namespace stratum::shade
