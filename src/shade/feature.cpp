#include "shade/feature.h"

namespace stratum::shade {

Pixel NormalIntegrator::radiance(const march::Ray& ray, TraceContext& context) const {
    SurfacePoint point;
    ++context.rays.primary;
    if (!surfaces_.nearest(ray, context.tracer, point)) return {};
    const float alpha = 1.0f - surfaces_.fade(point);
    return {glm::vec3(point.normal) * alpha, alpha};
}

Pixel DepthIntegrator::radiance(const march::Ray& ray, TraceContext& context) const {
    SurfacePoint point;
    ++context.rays.primary;
    if (!surfaces_.nearest(ray, context.tracer, point)) return {};
    const float alpha = 1.0f - surfaces_.fade(point);
    // A bed that the camera grazes is almost infinitely far away: 0 times that must be 0.
    return alpha > 0.0f ? Pixel{Color(static_cast<float>(point.t)) * alpha, alpha} : Pixel{};
}

Pixel PositionIntegrator::radiance(const march::Ray& ray, TraceContext& context) const {
    SurfacePoint point;
    ++context.rays.primary;
    if (!surfaces_.nearest(ray, context.tracer, point)) return {};
    const float alpha = 1.0f - surfaces_.fade(point);
    return {alpha * Color(point.position), alpha};
}

Pixel MaskIntegrator::radiance(const march::Ray& ray, TraceContext& context) const {
    SurfacePoint point;
    ++context.rays.primary;
    if (!surfaces_.nearest(ray, context.tracer, point) || point.bed) return {};
    return {Color(1.0f), 1.0f};
}

}  // namespace stratum::shade
