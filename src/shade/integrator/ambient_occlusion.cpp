#include "shade/integrator/ambient_occlusion.h"

#include "shade/camera/sampler_stream.h"
#include "shade/camera/sampling.h"
#include "shade/frame.h"

#include <cmath>
#include <vector>

namespace stratum::shade {

AmbientOcclusion::AmbientOcclusion(const SceneDescription& scene, const trace::Intersector& print, double distance)
    : Integrator(scene, print), opaque_(scene.backdrop.has_value()), distance_(distance) {}

std::optional<trace::Ray> AmbientOcclusion::feeler(const SurfacePoint& first, const glm::vec2& u) const {
    const glm::vec3 wi = toCosineHemisphere(u);
    if (!(wi.z > 0.0f) || surfaces_.fade(first) >= 1.0f) return std::nullopt;
    trace::Ray way = surfaces_.leave(first, Frame{glm::vec3(first.normal)}.toWorld(wi));
    way.t_max = distance_;
    return way;
}

Pixel AmbientOcclusion::unoccluded(const SurfacePoint* first) const {
    return first != nullptr || opaque_ ? Pixel{Color(1.0f), 1.0f} : Pixel{};
}

Pixel AmbientOcclusion::seen(const trace::Ray&, const SurfacePoint* first, TraceContext& context) const {
    if (first == nullptr) return unoccluded(first);
    const auto way = feeler(*first, context.sampler.next2D());
    if (!way) return unoccluded(first);
    ++context.rays.shadow;
    return {Color(surfaces_.occluded(*way, context.tracer) ? surfaces_.fade(*first) : 1.0f), 1.0f};
}

void AmbientOcclusion::seenStream(std::span<const trace::Ray> rays, std::span<const SurfacePoint> points,
                                  std::span<Sampler> samplers, trace::Tracer& tracer, RayCounts& counts,
                                  std::span<Pixel> pixels) const {
    std::vector<std::size_t> met;
    met.reserve(rays.size());
    for (std::size_t n = 0; n < rays.size(); ++n) {
        const bool meets = std::isfinite(points[n].t);
        pixels[n] = unoccluded(meets ? &points[n] : nullptr);
        if (meets) met.push_back(n);
    }
    std::vector<glm::vec2> draws(met.size());
    next2DStream(samplers, met, draws);
    std::vector<trace::Ray> ways;
    std::vector<std::size_t> owners;
    ways.reserve(met.size());
    owners.reserve(met.size());
    for (std::size_t k = 0; k < met.size(); ++k) {
        if (const auto way = feeler(points[met[k]], draws[k])) {
            ways.push_back(*way);
            owners.push_back(met[k]);
        }
    }
    counts.shadow += ways.size();
    std::vector<std::uint8_t> blocked(ways.size());
    surfaces_.occluded(ways, tracer, blocked);
    for (std::size_t k = 0; k < ways.size(); ++k)
        if (blocked[k] != 0) pixels[owners[k]].rgb = Color(surfaces_.fade(points[owners[k]]));
}

}  // namespace stratum::shade
