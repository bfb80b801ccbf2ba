#include "view/picture/quick_picture.h"

#include "base/parallel_for.h"
#include "shade/camera/filter.h"
#include "shade/camera/ray_streams.h"
#include "shade/camera/sampler.h"
#include "shade/film/tonemap.h"
#include "shade/integrator/ambient_occlusion.h"
#include "shade/integrator/render.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <memory>

namespace stratum::view {
namespace {

/// What the occlusion is smoothed by, and the picture without it.
struct Seen {
    glm::vec3 normal{0.0f};
    float depth = 0.0f;       // 0: nothing is hit
    float fade = 0.0f;        // share of the background
    float occlusion = 1.0f;   // 1: open
    shade::Color open{0.0f};  // radiance if nothing is in the light's way
    shade::Color behind{0.0f};
};

/// Occluders that are farther away than this share of the print's size darken nothing.
constexpr double kReach = 0.35;

class QuickRenderer {
public:
    QuickRenderer(const ViewedPicture& picture, const shade::BareLight& light)
        : picture_(picture),
          scene_(picture.scene),
          light_(light),
          width_(scene_.camera.width()),
          height_(scene_.camera.height()),
          surfaces_(scene_, *picture.print),
          occlusion_(scene_, *picture.print, reachOf(*picture.print)),
          seen_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) {}

    std::vector<std::uint8_t> run() {
        const auto tiles = shade::tilesOf({0, 0, width_, height_});
        PerThread<std::unique_ptr<trace::Tracer>> tracers([this] { return picture_.print->makeTracer(); });
        parallelFor(tiles.size(), 1, [&](std::size_t first, std::size_t last) {
            for (std::size_t n = first; n != last; ++n) trace(tiles[n], *tracers.local());
        });
        smooth(1, 0);
        smooth(0, 1);
        return display();
    }

private:
    static double reachOf(const trace::Intersector& print) {
        const trace::Box box = print.bounds();
        const double size = glm::length(box.max - box.min);
        return std::isfinite(size) && size > 0.0 ? kReach * size : trace::kInfinity;
    }

    void trace(const shade::PixelBox& tile, trace::Tracer& tracer) {
        std::vector<glm::ivec2> pixels;
        std::vector<shade::Sampler> samplers;
        for (int y = tile.y0; y < tile.y1; ++y)
            for (int x = tile.x0; x < tile.x1; ++x) {
                pixels.emplace_back(x, y);
                samplers.emplace_back(0u, 1u).start(x, y, 0);
            }
        std::vector<trace::Ray> rays(pixels.size());
        std::vector<shade::SurfacePoint> points(pixels.size());
        std::vector<shade::Pixel> open(pixels.size());
        std::vector<shade::Color> behind(pixels.size(), shade::Color(0.0f));
        shade::primaryRays(scene_.camera, filter_, pixels, samplers, rays);
        shade::RayCounts ignored;
        occlusion_.radianceStream(rays, samplers, tracer, ignored, points, open);
        if (!surfaces_.backdrop(rays, behind) && scene_.environment->visible()) {
            std::vector<glm::vec3> directions;
            directions.reserve(rays.size());
            for (const trace::Ray& ray : rays) directions.emplace_back(ray.direction);
            scene_.environment->radianceStream(directions, behind);
        }
        for (std::size_t n = 0; n < pixels.size(); ++n) {
            Seen& seen = seen_[index(pixels[n].x, pixels[n].y)];
            seen.behind = behind[n];
            if (std::isfinite(points[n].t)) shade(points[n], rays[n].direction, open[n].rgb.r, seen);
        }
    }

    void shade(const shade::SurfacePoint& point, const glm::dvec3& direction, float open, Seen& seen) const {
        constexpr float kGloss = 0.04f;  // of plastic, seen from the front
        const glm::dvec3 mirror = direction - 2.0 * glm::dot(direction, point.normal) * point.normal;
        seen.normal = glm::vec3(point.normal);
        seen.depth = static_cast<float>(point.t);
        seen.fade = surfaces_.fade(point);
        seen.occlusion = open;
        seen.open = light_.brightest() * point.albedo * light_.matt(seen.normal);
        if (!point.bed) seen.open += light_.brightest() * kGloss * light_.gloss(glm::vec3(mirror));
    }

    // One direction of a joint bilateral filter.
    void smooth(int dx, int dy) {
        constexpr int kRadius = 4;
        constexpr std::size_t kRows = 8;
        std::vector<float> result(seen_.size());
        parallelFor(static_cast<std::size_t>(height_), kRows, [&](std::size_t first, std::size_t last) {
            for (int y = static_cast<int>(first); y < static_cast<int>(last); ++y)
                for (int x = 0; x < width_; ++x) {
                    const Seen& here = seen_[index(x, y)];
                    float sum = 0.0f;
                    float weights = 0.0f;
                    for (int k = -kRadius; k <= kRadius && here.depth > 0.0f; ++k) {
                        const int nx = x + k * dx;
                        const int ny = y + k * dy;
                        if (nx < 0 || ny < 0 || nx >= width_ || ny >= height_) continue;
                        const Seen& there = seen_[index(nx, ny)];
                        // Neighbours on the same layer line count, and those of the next one a little.
                        const float like = std::max(0.0f, glm::dot(here.normal, there.normal));
                        const float apart = std::abs(there.depth - here.depth) / (0.01f * here.depth);
                        const float weight =
                            like * like * std::max(0.0f, 1.0f - apart) * (there.depth > 0.0f ? 1.0f : 0.0f);
                        sum += weight * there.occlusion;
                        weights += weight;
                    }
                    result[index(x, y)] = weights > 0.0f ? sum / weights : here.occlusion;
                }
        });
        for (std::size_t n = 0; n < seen_.size(); ++n) seen_[n].occlusion = result[n];
    }

    std::vector<std::uint8_t> display() const {
        shade::Film film(width_, height_, {0, 0, width_, height_});
        for (std::size_t n = 0; n < seen_.size(); ++n) {
            const Seen& seen = seen_[n];
            const shade::Color lit = seen.occlusion * seen.open;
            const float fade = seen.depth > 0.0f ? seen.fade : 1.0f;
            film.pixels()[n] = {lit * (1.0f - fade) + seen.behind * fade, 1.0f};
        }
        return shade::toDisplay(film, picture_.tone);
    }

    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
    }

    const ViewedPicture& picture_;
    const shade::SceneDescription& scene_;
    const shade::BareLight& light_;
    const int width_, height_;
    const shade::PixelFilter filter_;
    const shade::Surfaces surfaces_;
    const shade::AmbientOcclusion occlusion_;
    std::vector<Seen> seen_;
};

}  // namespace

std::vector<std::uint8_t> quickPicture(const ViewedPicture& picture, const shade::BareLight& light) {
    return QuickRenderer(picture, light).run();
}

}  // namespace stratum::view
