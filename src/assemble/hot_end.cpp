#include "assemble/hot_end.h"

#include "assemble/print/lazy_print.h"
#include "base/error.h"
#include "base/parallel_for.h"
#include "shade/finish/named_brdf.h"
#include "trace/box_corners.h"
#include "trace/convex_solid.h"
#include "trace/scene_intersector.h"

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace stratum::assemble {
namespace {

// Reflectances at normal incidence: brass, aluminium and iron as in "Physically Based" (physicallybased.info, 2023).
constexpr std::string_view kBrass = "metal:0.91,0.78,0.42,0.25";
constexpr std::string_view kAluminium = "metal:0.91,0.92,0.92,0.35";
constexpr std::string_view kSteel = "metal:0.53,0.51,0.49,0.3";

HotEndPart cylinder(double low, double height, double diameter, std::string_view metal) {
    return {trace::makeConeSolid(low, 0.5 * diameter, low + height, 0.5 * diameter), metal};
}

std::vector<HotEndPart> slender() {
    return {{trace::makeConeSolid(0, 0.5, 3, 3.0), kBrass},
            {trace::makeHexagonSolid(7, 3, 6), kBrass},
            {trace::makeBoxSolid({-6, -6, 6}, {9, 6, 14}), kSteel},
            cylinder(14, 3, 3.2, kSteel),
            cylinder(17, 10, 10, kAluminium)};
}

// Heat break and heat sink of a V6, above a block that ends at `block_top`.
void addColdEnd(std::vector<HotEndPart>& parts, double block_top) {
    constexpr double kGap = 2.1;  // of the heat break, which is free there
    constexpr int kFins = 11;
    constexpr double kFinPitch = 2.5;
    const double sink = block_top + kGap;
    parts.push_back(cylinder(block_top, kGap, 2.96, kSteel));
    parts.push_back(cylinder(sink, 30, 9, kAluminium));
    for (int fin = 0; fin < kFins; ++fin)
        parts.push_back(cylinder(sink + fin * kFinPitch, 1, fin == 0 ? 22.3 : 22.0, kAluminium));
    parts.push_back(cylinder(sink + 27.5, 1, 16, kAluminium));
    // The groove that it is held by.
    parts.push_back(cylinder(sink + 30, 3, 16, kAluminium));
    parts.push_back(cylinder(sink + 33, 6, 12, kAluminium));
    parts.push_back(cylinder(sink + 39, 3.7, 16, kAluminium));
}

std::vector<HotEndPart> v6() {
    std::vector<HotEndPart> parts = {{trace::makeConeSolid(0, 0.5, 2, 2.5), kBrass},
                                     {trace::makeHexagonSolid(7, 2, 5), kBrass},
                                     cylinder(5, 1, 5, kBrass),
                                     {trace::makeBoxSolid({-15, -8, 6}, {8, 8, 17.5}), kAluminium}};
    addColdEnd(parts, 17.5);
    return parts;
}

std::vector<HotEndPart> volcano() {
    std::vector<HotEndPart> parts = {{trace::makeConeSolid(0, 0.5, 3, 3.0), kBrass},
                                     {trace::makeHexagonSolid(7, 2, 5), kBrass},
                                     cylinder(5, 2, 5, kBrass),
                                     {trace::makeBoxSolid({-4.5, -4.5, 6}, {7, 15.5, 24.5}), kAluminium},
                                     {trace::makeBoxSolid({-4.5, -4.5, 24.5}, {7, 7.5, 26}), kAluminium}};
    addColdEnd(parts, 26);
    return parts;
}

}  // namespace

std::vector<HotEndPart> makeHotEndParts(HotEndShape shape) {
    switch (shape) {
        case HotEndShape::v6:
            return v6();
        case HotEndShape::volcano:
            return volcano();
        case HotEndShape::slender:
            break;
    }
    return slender();
}

namespace {

constexpr double kPartOfThat = 40.0;  // mm: the larger side of the smallest part under a hot end of full size
constexpr double kSmallest = 0.25;

double scaleFor(const TracedObjects& objects, HotEndShape shape) {
    if (shape != HotEndShape::slender) return 1.0;
    const trace::Box box = objects.part ? *objects.part : objects.intersector->bounds();
    const glm::dvec3 size = box.max - box.min;
    return std::clamp(std::max({size.x, size.y, size.z}) / kPartOfThat, kSmallest, 1.0);
}

std::vector<trace::SceneObject> placedAt(const glm::dvec3& tip, const std::vector<HotEndPart>& parts, double scale,
                                         double tilt) {
    std::vector<trace::SceneObject> placed;
    placed.reserve(parts.size());
    for (const HotEndPart& part : parts)
        placed.push_back({part.solid, trace::Placement::of(glm::dvec3(scale), {tilt, 0.0, 0.0}, tip)});
    return placed;
}

// The pixels of a film that may show what is in a box.
shade::PixelBox pixelsOf(const trace::Box& box, const shade::Camera& camera, const shade::PixelBox& region) {
    shade::PixelBox pixels{region.x1, region.y1, region.x0, region.y0};
    for (const glm::dvec3& corner : trace::cornersOf(box)) {
        const std::optional<glm::dvec2> at = camera.project(corner);
        if (!at) return region;
        const auto within = [](double value, int low, int high) {
            return static_cast<int>(std::clamp(value, static_cast<double>(low), static_cast<double>(high)));
        };
        pixels.x0 = std::min(pixels.x0, within(std::floor(at->x), region.x0, region.x1));
        pixels.y0 = std::min(pixels.y0, within(std::floor(at->y), region.y0, region.y1));
        pixels.x1 = std::max(pixels.x1, within(std::ceil(at->x), region.x0, region.x1));
        pixels.y1 = std::max(pixels.y1, within(std::ceil(at->y), region.y0, region.y1));
    }
    return pixels;
}

// Thin glass that is tinted as a metal: clear where it is seen straight, denser where it is seen at a grazing angle,
// lit from above over the left shoulder of who looks.
class Glass {
public:
    Glass(const shade::Camera& camera, double white, const std::vector<HotEndPart>& parts)
        : white_(white), light_(glm::normalize(glm::dvec3(0, 0, 1) - 0.7 * camera.right() - camera.forward())) {
        for (const HotEndPart& part : parts)
            tints_.push_back(shade::ObjectMaterial(shade::makeBrdf(part.metal)).only().albedo);
    }

    shade::Pixel seen(const trace::Hit& hit, const glm::dvec3& direction) const {
        const double grazing = 1.0 - std::abs(glm::dot(hit.normal, direction));
        const double density = 0.3 + 0.6 * grazing * grazing * grazing;
        const double shine = 0.3 + 0.7 * std::max(0.0, glm::dot(hit.normal, light_));
        return {tints_[hit.object] * static_cast<float>(density * shine * white_), static_cast<float>(density)};
    }

private:
    double white_;
    glm::dvec3 light_;
    std::vector<shade::Color> tints_;
};

}  // namespace

HotEnd::HotEnd(const TracedObjects& objects, shade::SceneDescription& scene, const HotEndLook& look)
    : print_(objects.intersector),
      kind_(look.kind),
      parts_(makeHotEndParts(look.shape)),
      scale_(scaleFor(objects, look.shape)) {
    if (objects.prints.empty())
        throw UsageError("--nozzle needs G-code: a level set doesn't know where its last bead ends");
    layers_ = objects.prints.front();
    tilt_ = layers_->finest().layout().toolpath->belt_angle;
    if (kind_ != HotEndKind::metal) return;
    if (scene.objects.empty()) scene.objects.emplace_back(scene.material);
    for (const HotEndPart& part : parts_) scene.objects.emplace_back(shade::makeBrdf(part.metal));
}

std::shared_ptr<const trace::Intersector> HotEnd::at(std::size_t moment) const {
    return kind_ == HotEndKind::metal ? withHotEnd(print_, layers_->tipAt(moment), parts_, scale_, tilt_) : print_;
}

void HotEnd::drawOver(std::size_t moment, const shade::Camera& camera, double white, shade::Film& film) const {
    if (kind_ != HotEndKind::clear) return;
    const auto solids = trace::makeSceneIntersector(placedAt(layers_->tipAt(moment), parts_, scale_, tilt_));
    const shade::PixelBox pixels = pixelsOf(solids->bounds(), camera, film.region());
    if (pixels.width() <= 0 || pixels.height() <= 0) return;
    const Glass glass(camera, white, parts_);
    constexpr int kSide = 3;  // samples of a pixel, each way
    parallelFor(static_cast<std::size_t>(pixels.height()), 8, [&](std::size_t begin, std::size_t end) {
        const auto hot_end = solids->makeTracer();
        const auto print = print_->makeTracer();
        for (int y = pixels.y0 + static_cast<int>(begin); y < pixels.y0 + static_cast<int>(end); ++y)
            for (int x = pixels.x0; x < pixels.x1; ++x) {
                shade::Pixel over;
                for (int n = 0; n < kSide * kSide; ++n) {
                    trace::Ray ray = camera.ray(
                        glm::dvec2(x + (n % kSide + 0.5) / kSide, y + (n / kSide + 0.5) / kSide));  // NOLINT: rows
                    trace::Hit hit;
                    if (!hot_end->intersect(ray, hit)) continue;
                    ray.t_max = hit.t;
                    if (print->occluded(ray)) continue;
                    const shade::Pixel seen = glass.seen(hit, ray.direction);
                    over.rgb += seen.rgb / static_cast<float>(kSide * kSide);
                    over.alpha += seen.alpha / static_cast<float>(kSide * kSide);
                }
                shade::Pixel& pixel = film.at(x, y);
                pixel.rgb = pixel.rgb * (1.0F - over.alpha) + over.rgb;
                pixel.alpha = pixel.alpha * (1.0F - over.alpha) + over.alpha;
            }
    });
}

std::shared_ptr<const trace::Intersector> withHotEnd(const std::shared_ptr<const trace::Intersector>& print,
                                                     const glm::dvec3& tip, const std::vector<HotEndPart>& parts,
                                                     double scale, double tilt) {
    std::vector<trace::SceneObject> objects = placedAt(tip, parts, scale, tilt);
    objects.insert(objects.begin(), {print, {}});
    return trace::makeSceneIntersector(std::move(objects));
}

}  // namespace stratum::assemble
