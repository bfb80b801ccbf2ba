// PathIntegrator on the bed: what the print takes from its light. That is all that a transparent picture shows of it,
// see ShadowCatcher, and all that must be sampled in others.
#include "shade/camera/sampling.h"
#include "shade/integrator/path.h"

#include <algorithm>
#include <cmath>

namespace stratum::shade {

float PathIntegrator::BareBed::share(const glm::dvec3& place) const {
    const double height = print.max.z - place.z;
    if (!(height > 0.0)) return 1.0f;
    const double x = std::max({print.min.x - place.x, place.x - print.max.x, 0.0});
    const double y = std::max({print.min.y - place.y, place.y - print.max.y, 0.0});
    const double cotangent = std::hypot(x, y) / height;  // of the elevation of its top, at least; 0 for endless prints
    return static_cast<float>(1.0 - 0.5 / (1.0 + cotangent * cotangent));
}

void PathIntegrator::addBare(std::span<const SurfacePoint> points, const ShadowRays& shadow_rays,
                             std::span<const Bounce> bounces, std::span<Color> bare) const {
    // What goes down from a bumpy bed meets the bed itself, with or without a print.
    const auto add = [&](std::size_t pixel, const trace::Ray& ray, const Color& light) {
        if (points[pixel].bed && ray.direction.z > 0.0) bare[pixel] += light;
    };
    for (const Bounce& bounce : bounces) {
        const Path& path = *bounce.from->path;
        if (points[path.pixel].bed) bare[path.pixel] += path.throughput * scene_.ambient;
    }
    for (std::size_t k = 0; k < shadow_rays.rays.size(); ++k)
        add(shadow_rays.pixel[k], shadow_rays.rays[k], shadow_rays.light[k]);
    for (const Bounce& bounce : bounces) {
        const Path& path = *bounce.from->path;
        add(path.pixel, bounce.ray, path.throughput * bounce.escaped);
    }
}

void PathIntegrator::reduceBedNoise(std::span<const SurfacePoint> points, std::span<const Color> bare,
                                    std::span<Color> sums) const {
    for (std::size_t n = 0; n < points.size(); ++n)
        if (std::isfinite(points[n].t) && points[n].bed)
            sums[n] += bare_bed_->share(points[n].position) * (points[n].albedo * bare_bed_->radiance - bare[n]);
}

void PathIntegrator::catchShadows(std::span<const SurfacePoint> points, std::span<const Color> sums,
                                  std::span<const Color> bare, std::span<Pixel> pixels) const {
    constexpr int kPlaces = 4;  // on a side of a light: its irradiance is a scale, not a shadow
    for (std::size_t n = 0; n < points.size(); ++n) {
        const SurfacePoint& point = points[n];
        if (!std::isfinite(point.t)) {
            pixels[n] = {};
        } else if (!point.bed) {
            pixels[n] = {sums[n], 1.0f};
        } else {
            Color irradiance = scene_.catcher->irradiance;
            for (const auto& light : scene_.lights) irradiance += irradianceFrom(*light, point.position, kPlaces);
            const float all = luminance(point.albedo * irradiance) * kInvPi;
            pixels[n] = {Color(0.0f), all > 0.0f ? luminance(bare[n] - sums[n]) / all : 0.0f};
        }
    }
}

}  // namespace stratum::shade
