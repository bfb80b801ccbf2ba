#include "shade/ambient_occlusion.h"

#include "shade/frame.h"
#include "shade/sampling.h"

namespace stratum::shade {

AmbientOcclusion::AmbientOcclusion(const SceneDescription& scene, const march::Intersector& print, double distance)
    : surfaces_(scene, print), opaque_(scene.backdrop.has_value()), distance_(distance) {}

Pixel AmbientOcclusion::radiance(const march::Ray& ray, TraceContext& context) const {
    SurfacePoint point;
    ++context.rays.primary;
    if (!surfaces_.nearest(ray, context.tracer, point)) return opaque_ ? Pixel{Color(1.0f), 1.0f} : Pixel{};
    const float fade = surfaces_.fade(point);
    const glm::vec3 wi = toCosineHemisphere(context.sampler.next2D());
    if (!(wi.z > 0.0f) || fade >= 1.0f) return {Color(1.0f), 1.0f};
    march::Ray way = surfaces_.leave(point, Frame{glm::vec3(point.normal)}.toWorld(wi));
    way.t_max = distance_;
    ++context.rays.shadow;
    return {Color(surfaces_.occluded(way, context.tracer) ? fade : 1.0f), 1.0f};
}

}  // namespace stratum::shade
