#include "shade/path.h"

#include "shade/sampling.h"

namespace stratum::shade {

PathIntegrator::PathIntegrator(const SceneDescription& scene, const march::Intersector& print, int bounces)
    : Integrator(scene, print), scene_(scene), bounces_(bounces) {
    if (scene.bed) bed_light_.emplace(*scene.environment);
}

Pixel PathIntegrator::seen(const march::Ray& ray, const SurfacePoint* first, TraceContext& context) const {
    Color behind(0.0f);
    if (first == nullptr) return surfaces_.backdrop(ray, behind) ? Pixel{behind, 1.0f} : Pixel{};
    const float fade = surfaces_.fade(*first);
    if (fade > 0.0f) surfaces_.backdrop(ray, behind);
    if (fade >= 1.0f) return {behind, 1.0f};
    return {(1.0f - fade) * scattered(*first, ray.direction, context) + fade * behind, 1.0f};
}

/// Sum over the directional lights of what they send to the viewer by this point.
Color PathIntegrator::fromLights(const SurfacePoint& point, const Frame& frame, const glm::vec3& wo,
                                 TraceContext& context) const {
    Color sum(0.0f);
    for (const DirectionalLight& light : scene_.lights) {
        const glm::vec3 wi = frame.toLocal(light.to_light);
        const Color value = point.brdf->eval(wo, wi) * std::max(wi.z, 0.0f) * light.irradiance;
        if (!(maxComponent(value) > 0.0f)) continue;
        ++context.rays.shadow;
        if (!surfaces_.occluded(surfaces_.leave(point, light.to_light), context.tracer)) sum += value;
    }
    return sum;
}

/// One sample of the environment by its own density. On the print the BRDF's sample complements it.
Color PathIntegrator::fromEnvironment(const SurfacePoint& point, const Frame& frame, const glm::vec3& wo,
                                      TraceContext& context) const {
    const glm::vec2 draw = context.sampler.next2D();
    const EnvironmentSample light = point.bed ? bed_light_->sample(draw) : scene_.environment->sample(draw);
    const glm::vec3 wi = frame.toLocal(light.direction);
    if (!(light.pdf > 0.0f && wi.z > 0.0f)) return Color(0.0f);
    const float weight = point.bed ? 1.0f : powerHeuristic(light.pdf, point.brdf->pdf(wo, wi));
    const Color value = point.brdf->eval(wo, wi) * (wi.z * weight / light.pdf) * light.radiance;
    if (!(maxComponent(value) > 0.0f)) return Color(0.0f);
    ++context.rays.shadow;
    return surfaces_.occluded(surfaces_.leave(point, light.direction), context.tracer) ? Color(0.0f) : value;
}

/// Light that leaves a point against `direction`, the way of the ray that met it.
Color PathIntegrator::scattered(SurfacePoint point, glm::dvec3 direction, TraceContext& context) const {
    const Environment& environment = *scene_.environment;
    Color sum(0.0f);
    Color throughput(1.0f);
    for (int bounce = 1;; ++bounce) {
        const Frame frame{glm::vec3(point.normal)};
        const glm::vec3 wo = frame.toLocal(glm::vec3(-direction));
        // The draws of a bounce are always the same ones, so that each keeps its stratification.
        sum += throughput * fromEnvironment(point, frame, wo, context);
        sum += throughput * fromLights(point, frame, wo, context);
        const float lobe_draw = context.sampler.next1D();
        const glm::vec2 brdf_draw = context.sampler.next2D();

        const std::optional<BrdfSample> next = point.brdf->sample(wo, lobe_draw, brdf_draw);
        if (!next) return sum;
        throughput *= next->f * (next->wi.z / next->pdf);
        if (!(maxComponent(throughput) > 0.0f)) return sum;
        const glm::vec3 way = frame.toWorld(next->wi);
        const march::Ray ray = surfaces_.leave(point, way);
        // What the ray brings home if it meets nothing.
        Color escaped(0.0f);
        if (!point.bed)
            escaped = throughput * environment.radiance(way) * powerHeuristic(next->pdf, environment.pdf(way));
        const bool bright = maxComponent(escaped) > 0.0f;
        const bool last = bounce == bounces_;
        if (last && !bright) return sum;
        ++context.rays.bounce;
        if (last ? surfaces_.occluded(ray, context.tracer) : surfaces_.nearest(ray, context.tracer, point)) {
            if (last) return sum;
            direction = ray.direction;
        } else {
            return sum + escaped;
        }
    }
}

}  // namespace stratum::shade
