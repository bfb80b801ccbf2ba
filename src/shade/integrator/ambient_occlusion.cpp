#include "shade/integrator/ambient_occlusion.h"

#include "shade/camera/sampler_stream.h"
#include "shade/camera/sampling.h"
#include "shade/frame.h"

#include <cmath>
#include <vector>

namespace stratum::shade {

AmbientOcclusion::AmbientOcclusion(const SceneDescription& scene, const trace::Intersector& print, double distance)
    : Integrator(scene, print), opaque_(scene.backdrop.has_value()), distance_(distance) {}

bool AmbientOcclusion::shadowRay(const SurfacePoint& first, const glm::vec2& u, trace::Ray& ray) const {
    const glm::vec3 wi = toCosineHemisphere(u);
    if (!(wi.z > 0.0f) || surfaces_.fade(first) >= 1.0f) return false;
    ray = surfaces_.leave(first, Frame{glm::vec3(first.normal)}.toWorld(wi));
    ray.t_max = distance_;
    return true;
}

Pixel AmbientOcclusion::unoccluded(const SurfacePoint* first) const {
    return first != nullptr || opaque_ ? Pixel{Color(1.0f), 1.0f} : Pixel{};
}

Pixel AmbientOcclusion::seen(const trace::Ray&, const SurfacePoint* first, TraceContext& context) const {
    if (first == nullptr) return unoccluded(first);
    trace::Ray ray;
    if (!shadowRay(*first, context.sampler.next2D(), ray)) return unoccluded(first);
    ++context.rays.shadow;
    return {Color(surfaces_.occluded(ray, context.tracer) ? surfaces_.fade(*first) : 1.0f), 1.0f};
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
    // Kept by the thread, as in Surfaces::nearest().
    static thread_local std::vector<trace::Ray> shadow_rays;
    if (shadow_rays.size() < hits.size()) shadow_rays.resize(hits.size());
    std::vector<std::size_t> pixel_of(hits.size());
    std::size_t count = 0;
    for (std::size_t k = 0; k < hits.size(); ++k) {
        pixel_of[count] = hits[k];
        count += shadowRay(points[hits[k]], draws[k], shadow_rays[count]) ? 1 : 0;
    }
    counts.shadow += count;
    std::vector<std::uint8_t> blocked(count);
    surfaces_.occluded(std::span(shadow_rays).first(count), tracer, blocked);
    for (std::size_t k = 0; k < count; ++k)
        if (blocked[k] != 0) pixels[pixel_of[k]].rgb = Color(surfaces_.fade(points[pixel_of[k]]));
}

}  // namespace stratum::shade
