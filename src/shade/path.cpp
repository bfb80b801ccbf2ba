#include "shade/path.h"

#include "shade/sampling.h"

#include <cmath>
#include <cstdint>
#include <limits>

namespace stratum::shade {
namespace {

/// What a cosine sample of the bed counts in its weight against one of BedLight. With 1 the open bed would be as noisy
/// as the cosine is; with 0 the shadow of a sun would be lit by the few samples that miss the sun.
constexpr float kBedShare = 0.25f;
constexpr double kFar = std::numeric_limits<double>::infinity();

}  // namespace

PathIntegrator::PathIntegrator(const SceneDescription& scene, const march::Intersector& print, int bounces)
    : Integrator(scene, print), scene_(scene), bounces_(bounces) {
    if (scene.bed) bed_light_ = scene.environment->makeBedLight();
    for (const auto& light : scene.lights)
        if (light->hasExtent()) lamps_.push_back(light.get());
}

Pixel PathIntegrator::seen(const march::Ray& ray, const SurfacePoint* first, TraceContext& context) const {
    SurfacePoint point;
    if (first == nullptr)
        point.t = kFar;
    else
        point = *first;
    Pixel pixel;
    seenStream({&ray, 1}, {&point, 1}, {&context.sampler, 1}, context.tracer, context.rays, {&pixel, 1});
    return pixel;
}

void PathIntegrator::Feelers::add(const march::Ray& ray, const Color& value, std::size_t to) {
    rays.push_back(ray);
    light.push_back(value);
    pixel.push_back(to);
}

/// One sample of each lamp.
void PathIntegrator::feelLights(const Path& path, const Frame& frame, const glm::vec3& wo, Sampler& sampler,
                                Feelers& feelers) const {
    const SurfacePoint& point = path.point;
    for (const auto& light : scene_.lights) {
        const glm::vec2 draw = light->hasExtent() ? sampler.next2D() : glm::vec2(0.0f);
        const std::optional<LightSample> sample = light->sample(point.position, draw);
        if (!sample) continue;
        const glm::vec3 wi = frame.toLocal(sample->direction);
        Color value = path.throughput * point.brdf->eval(wo, wi) * std::max(wi.z, 0.0f) * sample->light;
        if (sample->pdf > 0.0f) value *= powerHeuristic(sample->pdf, point.brdf->pdf(wo, wi)) / sample->pdf;
        if (!(maxComponent(value) > 0.0f)) continue;
        march::Ray ray = surfaces_.leave(point, sample->direction);
        ray.t_max = sample->distance;
        feelers.add(ray, value, path.pixel);
    }
}

Color PathIntegrator::fromLamps(const march::Ray& ray, double t, float pdf) const {
    Color sum(0.0f);
    for (const Light* lamp : lamps_) {
        const std::optional<LightMeeting> meeting = lamp->meet(ray);
        if (meeting && meeting->t <= t) sum += meeting->radiance * powerHeuristic(pdf, meeting->pdf);
    }
    return sum;
}

/// A sample of the environment by each of its strategies. On the print the BRDF's sample complements them.
void PathIntegrator::feelEnvironment(const Path& path, const Frame& frame, const glm::vec3& wo, Sampler& sampler,
                                     Feelers& feelers) const {
    const SurfacePoint& point = path.point;
    const int strategies = point.bed ? bed_light_->strategies() : scene_.environment->strategies();
    for (int strategy = 0; strategy < strategies; ++strategy) {
        const glm::vec2 draw = sampler.next2D();
        const EnvironmentSample light =
            point.bed ? bed_light_->sample(strategy, draw) : scene_.environment->sample(strategy, draw, frame.z);
        const glm::vec3 wi = frame.toLocal(light.direction);
        if (!(light.pdf > 0.0f && wi.z > 0.0f)) continue;
        const float other = (point.bed ? kBedShare : 1.0f) * point.brdf->pdf(wo, wi);
        const float weight = balanceHeuristic(light.pdf, other);
        const Color value = path.throughput * point.brdf->eval(wo, wi) * (wi.z * weight / light.pdf) * light.radiance;
        if (maxComponent(value) > 0.0f) feelers.add(surfaces_.leave(point, light.direction), value, path.pixel);
    }
}

std::optional<PathIntegrator::Bounce> PathIntegrator::scatter(Path& path, const Frame& frame, const glm::vec3& wo,
                                                              Sampler& sampler) const {
    const Environment& environment = *scene_.environment;
    const SurfacePoint& point = path.point;
    const float lobe_draw = sampler.next1D();
    const glm::vec2 brdf_draw = sampler.next2D();
    const std::optional<BrdfSample> next = point.brdf->sample(wo, lobe_draw, brdf_draw);
    if (!next) return std::nullopt;
    path.throughput *= next->f * (next->wi.z / next->pdf);
    if (!(maxComponent(path.throughput) > 0.0f)) return std::nullopt;
    const glm::vec3 way = frame.toWorld(next->wi);
    Bounce bounce{surfaces_.leave(point, way), next->pdf, Color(0.0f)};
    bounce.escaped = fromLamps(bounce.ray, kFar, next->pdf);
    if (point.bed) {
        bounce.escaped += environment.radiance(way) * balanceHeuristic(kBedShare * next->pdf, bed_light_->pdf(way));
    } else {
        const EnvironmentSample there = environment.toward(way, frame.z);
        bounce.escaped += there.radiance * balanceHeuristic(next->pdf, there.pdf);
    }
    return bounce;
}

void PathIntegrator::gather(const Feelers& feelers, march::Tracer& tracer, std::span<Color> sums) const {
    std::vector<std::uint8_t> blocked(feelers.rays.size());
    surfaces_.occluded(feelers.rays, tracer, blocked);
    for (std::size_t k = 0; k < blocked.size(); ++k)
        if (blocked[k] == 0) sums[feelers.pixel[k]] += feelers.light[k];
}

void PathIntegrator::seenStream(std::span<const march::Ray> rays, std::span<const SurfacePoint> points,
                                std::span<Sampler> samplers, march::Tracer& tracer, RayCounts& counts,
                                std::span<Pixel> pixels) const {
    std::vector<Color> sums(rays.size(), Color(0.0f));
    std::vector<Path> paths;
    for (std::size_t n = 0; n < rays.size(); ++n)
        if (std::isfinite(points[n].t) && surfaces_.fade(points[n]) < 1.0f)
            paths.push_back({points[n], rays[n].direction, Color(1.0f), n});

    for (int step = 1; step <= bounces_ && !paths.empty(); ++step) {
        const bool last = step == bounces_;
        Feelers feelers;
        // Those of the last step that nothing but the print can stop: an answer of yes or no will do.
        Feelers endings;
        std::vector<Path> going;
        std::vector<Bounce> bounces;
        for (Path& path : paths) {
            Sampler& sampler = samplers[path.pixel];
            const Frame frame{glm::vec3(path.point.normal)};
            const glm::vec3 wo = frame.toLocal(glm::vec3(-path.direction));
            // The draws of a step are always the same ones, so that each keeps its stratification.
            feelEnvironment(path, frame, wo, sampler, feelers);
            feelLights(path, frame, wo, sampler, feelers);
            const std::optional<Bounce> bounce = scatter(path, frame, wo, sampler);
            if (!bounce) continue;
            sums[path.pixel] += path.throughput * scene_.ambient;
            if (!last || !lamps_.empty()) {
                if (last && !(maxComponent(bounce->escaped) > 0.0f)) continue;
                going.push_back(path);
                bounces.push_back(*bounce);
            } else if (maxComponent(bounce->escaped) > 0.0f) {
                endings.add(bounce->ray, path.throughput * bounce->escaped, path.pixel);
            }
        }
        counts.shadow += feelers.rays.size();
        counts.bounce += endings.rays.size() + bounces.size();
        gather(feelers, tracer, sums);
        gather(endings, tracer, sums);

        std::vector<march::Ray> ways;
        ways.reserve(bounces.size());
        for (const Bounce& bounce : bounces) ways.push_back(bounce.ray);
        std::vector<SurfacePoint> met(ways.size());
        surfaces_.nearest(ways, tracer, met);
        paths.clear();
        for (std::size_t k = 0; k < bounces.size(); ++k) {
            Path& path = going[k];
            Color& sum = sums[path.pixel];
            if (!std::isfinite(met[k].t)) {
                sum += path.throughput * bounces[k].escaped;
                continue;
            }
            // Lamps stand in nobody's way, so that one may lie before the surface.
            sum += path.throughput * fromLamps(bounces[k].ray, met[k].t, bounces[k].pdf);
            path.point = met[k];
            path.direction = bounces[k].ray.direction;
            if (!last) paths.push_back(path);
        }
    }

    for (std::size_t n = 0; n < rays.size(); ++n) {
        const bool met = std::isfinite(points[n].t);
        const float fade = met ? surfaces_.fade(points[n]) : 1.0f;
        Color behind(0.0f);
        const bool backdrop = fade > 0.0f && surfaces_.backdrop(rays[n], behind);
        pixels[n] = met || backdrop ? Pixel{(1.0f - fade) * sums[n] + fade * behind, 1.0f} : Pixel{};
    }
}

}  // namespace stratum::shade
