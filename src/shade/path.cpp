#include "shade/path.h"

#include "shade/sampling.h"

#include <limits>

namespace stratum::shade {
namespace {

/// What a cosine sample of the bed counts in its weight against one of BedLight. With 1 the open bed would be as noisy
/// as the cosine is; with 0 the shadow of a sun would be lit by the few samples that miss the sun.
constexpr float kBedShare = 0.25f;

}  // namespace

PathIntegrator::PathIntegrator(const SceneDescription& scene, const march::Intersector& print, int bounces)
    : Integrator(scene, print), scene_(scene), bounces_(bounces) {
    if (scene.bed) bed_light_ = scene.environment->makeBedLight();
    for (const auto& light : scene.lights)
        if (light->hasExtent()) lamps_.push_back(light.get());
}

Pixel PathIntegrator::seen(const march::Ray& ray, const SurfacePoint* first, TraceContext& context) const {
    Color behind(0.0f);
    if (first == nullptr) return surfaces_.backdrop(ray, behind) ? Pixel{behind, 1.0f} : Pixel{};
    const float fade = surfaces_.fade(*first);
    if (fade > 0.0f) surfaces_.backdrop(ray, behind);
    if (fade >= 1.0f) return {behind, 1.0f};
    return {(1.0f - fade) * scattered(*first, ray.direction, context) + fade * behind, 1.0f};
}

/// Sum over the lamps of what they send to the viewer by this point.
Color PathIntegrator::fromLights(const SurfacePoint& point, const Frame& frame, const glm::vec3& wo,
                                 TraceContext& context) const {
    Color sum(0.0f);
    for (const auto& light : scene_.lights) {
        const glm::vec2 draw = light->hasExtent() ? context.sampler.next2D() : glm::vec2(0.0f);
        const std::optional<LightSample> sample = light->sample(point.position, draw);
        if (!sample) continue;
        const glm::vec3 wi = frame.toLocal(sample->direction);
        Color value = point.brdf->eval(wo, wi) * std::max(wi.z, 0.0f) * sample->light;
        if (sample->pdf > 0.0f) value *= powerHeuristic(sample->pdf, point.brdf->pdf(wo, wi)) / sample->pdf;
        if (!(maxComponent(value) > 0.0f)) continue;
        march::Ray ray = surfaces_.leave(point, sample->direction);
        ray.t_max = sample->distance;
        ++context.rays.shadow;
        if (!surfaces_.occluded(ray, context.tracer)) sum += value;
    }
    return sum;
}

Color PathIntegrator::fromLamps(const march::Ray& ray, double t, float pdf) const {
    Color sum(0.0f);
    for (const Light* lamp : lamps_) {
        const std::optional<LightMeeting> meeting = lamp->meet(ray);
        if (meeting && meeting->t <= t) sum += meeting->radiance * powerHeuristic(pdf, meeting->pdf);
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
    const float other = (point.bed ? kBedShare : 1.0f) * point.brdf->pdf(wo, wi);
    const float weight = balanceHeuristic(light.pdf, other);
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
        sum += throughput * scene_.ambient;
        const glm::vec3 way = frame.toWorld(next->wi);
        const march::Ray ray = surfaces_.leave(point, way);
        // What the ray brings home if it meets nothing.
        constexpr double kFar = std::numeric_limits<double>::infinity();
        Color escaped = fromLamps(ray, kFar, next->pdf);
        const float drawn = (point.bed ? kBedShare : 1.0f) * next->pdf;
        escaped += environment.radiance(way) *
                   balanceHeuristic(drawn, point.bed ? bed_light_->pdf(way) : environment.pdf(way));
        const bool last = bounce == bounces_;
        if (last && !(maxComponent(escaped) > 0.0f)) return sum;
        ++context.rays.bounce;
        if (last && lamps_.empty()) return surfaces_.occluded(ray, context.tracer) ? sum : sum + throughput * escaped;
        if (!surfaces_.nearest(ray, context.tracer, point)) return sum + throughput * escaped;
        // Lamps stand in nobody's way, so that one may lie before the surface.
        sum += throughput * fromLamps(ray, point.t, next->pdf);
        if (last) return sum;
        direction = ray.direction;
    }
}

}  // namespace stratum::shade
