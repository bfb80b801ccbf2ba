#include "shade/integrator/ambient_occlusion.h"

#include "shade/camera/sampler_stream.h"
#include "shade/camera/sampling.h"
#include "shade/frame.h"

#include <cmath>
#include <vector>

namespace stratum::shade {

AmbientOcclusion::AmbientOcclusion(const SceneDescription& scene, const trace::Intersector& print, double distance)
    : Integrator(scene, print), opaque_(scene.backdrop.has_value()), distance_(distance) {}

std::optional<trace::Ray> AmbientOcclusion::shadowRay(const SurfacePoint& first, const glm::vec2& u) const {
    const glm::vec3 wi = toCosineHemisphere(u);
    if (!(wi.z > 0.0f) || surfaces_.fade(first) >= 1.0f) return std::nullopt;
    trace::Ray ray = surfaces_.leave(first, Frame{glm::vec3(first.normal)}.toWorld(wi));
    ray.t_max = distance_;
    return ray;
}

Pixel AmbientOcclusion::unoccluded(const SurfacePoint* first) const {
    return first != nullptr || opaque_ ? Pixel{Color(1.0f), 1.0f} : Pixel{};
}

Pixel AmbientOcclusion::seen(const trace::Ray&, const SurfacePoint* first, TraceContext& context) const {
    if (first == nullptr) return unoccluded(first);
    const auto ray = shadowRay(*first, context.sampler.next2D());
    if (!ray) return unoccluded(first);
    ++context.rays.shadow;
    return {Color(surfaces_.occluded(*ray, context.tracer) ? surfaces_.fade(*first) : 1.0f), 1.0f};
}

void AmbientOcclusion::seenStream(std::span<const trace::Ray> rays, std::span<const SurfacePoint> points,
                                  std::span<Sampler> samplers, trace::Tracer& tracer, RayCounts& counts,
                                  std::span<Pixel> pixels) const {
    std::vector<std::size_t> hits;
    hits.reserve(rays.size());
    for (std::size_t n = 0; n < rays.size(); ++n) {
        const bool meets = std::isfinite(points[n].t);
        pixels[n] = unoccluded(meets ? &points[n] : nullptr);
        if (meets) hits.push_back(n);
    }
    std::vector<glm::vec2> draws(hits.size());
    next2DStream(samplers, hits, draws);
    std::vector<trace::Ray> shadow_rays;
    std::vector<std::size_t> pixel_of;
    shadow_rays.reserve(hits.size());
    pixel_of.reserve(hits.size());
    for (std::size_t k = 0; k < hits.size(); ++k) {
        if (const auto ray = shadowRay(points[hits[k]], draws[k])) {
            shadow_rays.push_back(*ray);
            pixel_of.push_back(hits[k]);
        }
    }
    counts.shadow += shadow_rays.size();
    std::vector<std::uint8_t> blocked(shadow_rays.size());
    surfaces_.occluded(shadow_rays, tracer, blocked);
    for (std::size_t k = 0; k < shadow_rays.size(); ++k)
        if (blocked[k] != 0) pixels[pixel_of[k]].rgb = Color(surfaces_.fade(points[pixel_of[k]]));
}

}  // namespace stratum::shade
