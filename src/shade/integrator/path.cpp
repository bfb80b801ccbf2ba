#include "shade/integrator/path.h"

#include "shade/camera/sampler_stream.h"
#include "shade/camera/sampling.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace stratum::shade {
namespace {

/// What a cosine sample of the bed counts in its weight against one of BedLight. With 1 the open bed would be as noisy
/// as the cosine is; with 0 the shadow of a sun would be lit by the few samples that miss the sun.
constexpr float kBedShare = 0.25f;
constexpr double kFar = std::numeric_limits<double>::infinity();

/// Sets the members of the groups: numbers of what stands on the print, and on the bed.
template <typename Groups, typename Things, typename IsBed>
void gatherGroups(Groups& groups, const Things& things, const IsBed& isBed) {
    for (auto& group : groups) group.members.clear();
    for (std::size_t n = 0; n < things.size(); ++n) groups[isBed(things[n]) ? 1 : 0].members.push_back(n);
}

}  // namespace

PathIntegrator::PathIntegrator(const SceneDescription& scene, const trace::Intersector& print, int bounces)
    : Integrator(scene, print), scene_(scene), bounces_(bounces) {
    if (scene.bed) bed_light_ = scene.environment->makeBedLight();
    for (const auto& light : scene.lights)
        if (light->hasExtent()) lamps_.push_back(light.get());
}

Pixel PathIntegrator::seen(const trace::Ray& ray, const SurfacePoint* first, TraceContext& context) const {
    SurfacePoint point;
    if (first == nullptr)
        point.t = kFar;
    else
        point = *first;
    Pixel pixel;
    seenStream({&ray, 1}, {&point, 1}, {&context.sampler, 1}, context.tracer, context.rays, {&pixel, 1});
    return pixel;
}

void PathIntegrator::Feelers::add(const trace::Ray& ray, const Color& value, std::size_t to) {
    rays.push_back(ray);
    light.push_back(value);
    pixel.push_back(to);
}

void PathIntegrator::Feelers::clear() {
    rays.clear();
    light.clear();
    pixel.clear();
}

void PathIntegrator::Looks::resize(std::size_t count) {
    normals.resize(count);
    samples.resize(count);
}

/// One sample of each lamp.
void PathIntegrator::feelLights(const Stand& stand, Sampler& sampler, Feelers& feelers) const {
    const Path& path = *stand.path;
    const SurfacePoint& point = path.point;
    const glm::vec3& wo = stand.wo;
    for (const auto& light : scene_.lights) {
        const glm::vec2 draw = light->hasExtent() ? sampler.next2D() : glm::vec2(0.0f);
        const std::optional<LightSample> sample = light->sample(point.position, draw);
        if (!sample) continue;
        const glm::vec3 wi = stand.frame.toLocal(sample->direction);
        Color value = path.throughput * point.brdf->eval(wo, wi) * std::max(wi.z, 0.0f) * sample->light;
        if (sample->pdf > 0.0f) value *= powerHeuristic(sample->pdf, point.brdf->pdf(wo, wi)) / sample->pdf;
        if (!(maxComponent(value) > 0.0f)) continue;
        trace::Ray ray = surfaces_.leave(point, sample->direction);
        ray.t_max = sample->distance;
        feelers.add(ray, value, path.pixel);
    }
}

Color PathIntegrator::fromLamps(const trace::Ray& ray, double t, float pdf) const {
    Color sum(0.0f);
    for (const Light* lamp : lamps_) {
        const std::optional<LightMeeting> meeting = lamp->meet(ray);
        if (meeting && meeting->t <= t) sum += meeting->radiance * powerHeuristic(pdf, meeting->pdf);
    }
    return sum;
}

/// A sample of the environment by each of its strategies. On the print the BRDF's sample complements them.
void PathIntegrator::feelEnvironment(const Group& group, std::span<const Stand> stands, std::span<Sampler> samplers,
                                     Feelers& feelers, Looks& looks) const {
    const std::size_t count = group.members.size();
    if (count == 0) return;  // there may be no bed
    const int strategies = group.bed ? bed_light_->strategies() : scene_.environment->strategies();
    looks.resize(count);
    looks.u.resize(count);
    looks.pixels.resize(count);
    for (std::size_t k = 0; k < count; ++k) {
        const Stand& stand = stands[group.members[k]];
        looks.pixels[k] = stand.path->pixel;
        looks.normals[k] = stand.frame.z;
    }
    for (int strategy = 0; strategy < strategies; ++strategy) {
        next2DStream(samplers, looks.pixels, looks.u);
        if (group.bed)
            bed_light_->sampleStream(strategy, looks.u, looks.samples);
        else
            scene_.environment->sampleStream(strategy, looks.u, looks.normals, looks.samples);
        for (std::size_t k = 0; k < count; ++k) {
            const Stand& stand = stands[group.members[k]];
            const EnvironmentSample& light = looks.samples[k];
            const SurfacePoint& point = stand.path->point;
            const glm::vec3 wi = stand.frame.toLocal(light.direction);
            if (!(light.pdf > 0.0f && wi.z > 0.0f)) continue;
            const float other = (group.bed ? kBedShare : 1.0f) * point.brdf->pdf(stand.wo, wi);
            const float weight = balanceHeuristic(light.pdf, other);
            const Color value =
                stand.path->throughput * point.brdf->eval(stand.wo, wi) * (wi.z * weight / light.pdf) * light.radiance;
            if (!(maxComponent(value) > 0.0f)) continue;
            feelers.add(surfaces_.leave(point, light.direction), value, stand.path->pixel);
        }
    }
}

std::optional<PathIntegrator::Bounce> PathIntegrator::scatter(Stand& stand, float lobe_draw,
                                                              const glm::vec2& brdf_draw) const {
    Path& path = *stand.path;
    const std::optional<BrdfSample> next = path.point.brdf->sample(stand.wo, lobe_draw, brdf_draw);
    if (!next) return std::nullopt;
    path.throughput *= next->f * (next->wi.z / next->pdf);
    if (!(maxComponent(path.throughput) > 0.0f)) return std::nullopt;
    const glm::vec3 way = stand.frame.toWorld(next->wi);
    Bounce bounce{&stand, surfaces_.leave(path.point, way), way, next->pdf, Color(0.0f)};
    bounce.escaped = fromLamps(bounce.ray, kFar, next->pdf);
    return bounce;
}

/// What the environment adds to the bounces of a group that escape.
void PathIntegrator::lookWhereTheyGo(const Group& group, std::span<Bounce> bounces, Looks& looks) const {
    const std::size_t count = group.members.size();
    if (count == 0) return;
    looks.resize(count);
    looks.ways.resize(count);
    for (std::size_t k = 0; k < count; ++k) {
        const Bounce& bounce = bounces[group.members[k]];
        looks.ways[k] = bounce.way;
        looks.normals[k] = bounce.from->frame.z;
    }
    if (group.bed)
        bed_light_->towardStream(looks.ways, looks.samples);
    else
        scene_.environment->towardStream(looks.ways, looks.normals, looks.samples);
    for (std::size_t k = 0; k < count; ++k) {
        Bounce& bounce = bounces[group.members[k]];
        const float own = (group.bed ? kBedShare : 1.0f) * bounce.pdf;
        bounce.escaped += looks.samples[k].radiance * balanceHeuristic(own, looks.samples[k].pdf);
    }
}

void PathIntegrator::gather(const Feelers& feelers, trace::Tracer& tracer, std::span<Color> sums) const {
    std::vector<std::uint8_t> blocked(feelers.rays.size());
    surfaces_.occluded(feelers.rays, tracer, blocked);
    for (std::size_t k = 0; k < blocked.size(); ++k)
        if (blocked[k] == 0) sums[feelers.pixel[k]] += feelers.light[k];
}

void PathIntegrator::seenStream(std::span<const trace::Ray> rays, std::span<const SurfacePoint> points,
                                std::span<Sampler> samplers, trace::Tracer& tracer, RayCounts& counts,
                                std::span<Pixel> pixels) const {
    // How much of the backdrop is seen in a place.
    const auto fadeOf = [this](const SurfacePoint& p) { return std::isfinite(p.t) ? surfaces_.fade(p) : 1.0f; };
    std::vector<Color> sums(rays.size(), Color(0.0f));
    std::vector<Path> paths;
    paths.reserve(rays.size());
    for (std::size_t n = 0; n < rays.size(); ++n)
        if (fadeOf(points[n]) < 1.0f) paths.push_back({points[n], rays[n].direction, Color(1.0f), n});

    Feelers feelers;
    // Those of the last step that nothing but the print can stop: an answer of yes or no will do.
    Feelers endings;
    Looks looks;
    std::array<Group, 2> groups{Group{false, {}}, Group{true, {}}};
    std::vector<Stand> stands;
    std::vector<glm::vec2> lobe_draws;
    std::vector<glm::vec2> brdf_draws;
    std::vector<Bounce> bounces;
    std::vector<trace::Ray> ways;
    std::vector<SurfacePoint> meetings;
    std::vector<Path> going;
    for (int step = 1; step <= bounces_ && !paths.empty(); ++step) {
        const bool last = step == bounces_;
        feelers.clear();
        endings.clear();
        stands.clear();
        bounces.clear();
        stands.reserve(paths.size());
        for (Path& path : paths) {
            const Frame frame{glm::vec3(path.point.normal)};
            stands.push_back({&path, frame, frame.toLocal(glm::vec3(-path.direction))});
        }
        // The draws of a step are always the same ones, so that each keeps its stratification.
        gatherGroups(groups, stands, [](const Stand& stand) { return stand.path->point.bed; });
        for (const Group& group : groups) feelEnvironment(group, stands, samplers, feelers, looks);
        looks.pixels.clear();
        for (const Stand& stand : stands) {
            feelLights(stand, samplers[stand.path->pixel], feelers);
            looks.pixels.push_back(stand.path->pixel);
        }
        lobe_draws.resize(stands.size());
        brdf_draws.resize(stands.size());
        next2DStream(samplers, looks.pixels, lobe_draws);
        next2DStream(samplers, looks.pixels, brdf_draws);
        for (std::size_t n = 0; n < stands.size(); ++n) {
            Stand& stand = stands[n];
            const std::optional<Bounce> bounce = scatter(stand, lobe_draws[n].x, brdf_draws[n]);
            if (!bounce) continue;
            sums[stand.path->pixel] += stand.path->throughput * scene_.ambient;
            bounces.push_back(*bounce);
        }
        gatherGroups(groups, bounces, [](const Bounce& bounce) { return bounce.from->path->point.bed; });
        for (const Group& group : groups) lookWhereTheyGo(group, bounces, looks);
        if (last) std::erase_if(bounces, [](const Bounce& b) { return !(maxComponent(b.escaped) > 0.0f); });
        const bool only_escape = last && lamps_.empty();
        if (only_escape)
            for (const Bounce& bounce : bounces) {
                const Path& path = *bounce.from->path;
                endings.add(bounce.ray, path.throughput * bounce.escaped, path.pixel);
            }
        counts.shadow += feelers.rays.size();
        counts.bounce += bounces.size();
        gather(feelers, tracer, sums);
        gather(endings, tracer, sums);
        if (only_escape) break;

        ways.clear();
        for (const Bounce& bounce : bounces) ways.push_back(bounce.ray);
        meetings.resize(ways.size());
        surfaces_.nearest(ways, tracer, meetings);
        going.clear();
        for (std::size_t k = 0; k < bounces.size(); ++k) {
            const Path& path = *bounces[k].from->path;
            Color& sum = sums[path.pixel];
            if (!std::isfinite(meetings[k].t)) {
                sum += path.throughput * bounces[k].escaped;
                continue;
            }
            // Lamps stand in nobody's way, so that one may lie before the surface.
            sum += path.throughput * fromLamps(bounces[k].ray, meetings[k].t, bounces[k].pdf);
            if (!last) going.push_back({meetings[k], bounces[k].ray.direction, path.throughput, path.pixel});
        }
        paths.swap(going);
    }

    ways.clear();
    for (std::size_t n = 0; n < rays.size(); ++n)
        if (fadeOf(points[n]) > 0.0f) ways.push_back(rays[n]);
    std::vector<Color> behind(ways.size(), Color(0.0f));
    const bool backdrop = surfaces_.backdrop(ways, behind);
    for (std::size_t n = 0, faded = 0; n < rays.size(); ++n) {
        const float fade = fadeOf(points[n]);
        Color color = (1.0f - fade) * sums[n];
        if (fade > 0.0f) color += fade * behind[faded++];
        pixels[n] = std::isfinite(points[n].t) || backdrop ? Pixel{color, 1.0f} : Pixel{};
    }
}

}  // namespace stratum::shade
