#include "shade/integrator/path.h"

#include "shade/camera/ray_streams.h"
#include "shade/camera/sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace stratum::shade {
namespace {

/// Factor of the BRDF's pdf in the balance heuristic on the bed, where its own sampler is the other strategy. With 1
/// the unoccluded bed would be as noisy as with cosine sampling; with 0 the shadow of a sun would be lit only by the
/// few samples of that sampler that miss the sun.
constexpr float kBedShare = 0.25f;
constexpr double kFar = std::numeric_limits<double>::infinity();
/// Surfaces that a path through translucent solids may meet: far more than roulette lets it.
constexpr int kMostSurfaces = 1 << 14;
/// Translucent surfaces that a path meets before the cache is asked. With two instead of four the error of clear
/// plastic at 512 samples was 1.8 times as large; with six it was no less.
constexpr int kFollowed = 4;
/// What a path sees after an opaque surface is a mean over directions already: there it is half of them.
constexpr int kFollowedAfterOpaque = 2;

/// Sets the members of the two groups: indices of things on the print, and of things on the bed.
template <typename Groups, typename Things, typename IsBed>
void gatherGroups(Groups& groups, const Things& things, const IsBed& isBed) {
    for (auto& group : groups) group.members.clear();
    for (std::size_t n = 0; n < things.size(); ++n) groups[isBed(things[n]) ? 1 : 0].members.push_back(n);
}

}  // namespace

PathIntegrator::PathIntegrator(const SceneDescription& scene, const trace::Intersector& print, int bounces,
                               const RadianceCache* cache)
    : Integrator(scene, print), scene_(scene), bounces_(bounces), cache_(cache) {
    if (scene.bed) bed_sampler_ = scene.environment->makeBedSampler();
    if (scene.bed && !scene.catcher && scene.lights.empty() && !scene.bed->texture.bumpy())
        bare_bed_ = BareBed{scene.environment->irradianceFromAbove() * kInvPi + scene.ambient, print.bounds()};
    for (const auto& light : scene.lights)
        if (light->hasExtent()) extended_lights_.push_back(light.get());
    if (scene.anyTranslucent()) walk_.emplace(surfaces_, print.bounds(), scene.mm_per_unit);
}

trace::Ray& PathIntegrator::ShadowRays::add(const Color& value, std::size_t to) {
    light.push_back(value);
    pixel.push_back(to);
    return rays.emplace_back();
}

void PathIntegrator::ShadowRays::reserve(std::size_t count) {
    rays.reserve(count);
    light.reserve(count);
    pixel.reserve(count);
}

void PathIntegrator::ShadowRays::clear() {
    rays.clear();
    light.clear();
    pixel.clear();
}

void PathIntegrator::LightBatch::resize(std::size_t count) {
    normals.resize(count);
    samples.resize(count);
}

bool PathIntegrator::endDeep(const PathState& state, const SurfacePoint& point, const glm::dvec3& direction,
                             const Stream& stream) const {
    if (cache_ == nullptr || state.crossings < (state.scatterings > 0 ? kFollowedAfterOpaque : kFollowed)) return false;
    const Side side = point.from_inside ? Side::solid : Side::air;
    Color& sum = stream.sums[state.pixel];
    if (stream.deep != nullptr) {
        stream.deep->push_back({cache_->cell(point.position, direction, side), static_cast<std::uint32_t>(state.pixel),
                                state.throughput, sum});
        return false;
    }
    Sampler& sampler = stream.samplers[state.pixel];
    const glm::vec2 xy = sampler.next2D();
    const glm::dvec3 u(xy.x, xy.y, sampler.next1D());
    const std::optional<Color> light = cache_->radiance(cache_->cellNear(point.position, direction, side, u));
    if (light) sum += state.throughput * *light;
    return light.has_value();
}

void PathIntegrator::addPath(const PathState& state, const SurfacePoint& point, const glm::dvec3& direction,
                             const Translucent* inside, const Stream& stream, std::vector<Path>& paths) const {
    const Translucent* solid = walk_ ? point.brdf->translucent() : nullptr;
    if (solid == nullptr ? state.scatterings >= bounces_ : endDeep(state, point, direction, stream)) return;
    Path& path = paths.emplace_back(state, point, direction);
    path.solid = solid;
    path.inside = inside;
    if (solid == nullptr) {
        ++path.scatterings;
        return;
    }
    ++path.crossings;
    path.point.brdf = &solid->fromAir(path.side());
    if (point.from_inside) {
        path.point.normal = -point.normal;
        path.point.geometric = -point.geometric;
    }
}

PathIntegrator::PathVertex::PathVertex(Path& of)
    : path(&of),
      frame(of.point.grain == glm::vec3(0.0f) ? Frame(glm::vec3(of.point.normal))
                                              : Frame(glm::vec3(of.point.normal), of.point.grain)),
      wo(frame.toLocal(glm::vec3(-of.direction))),
      bent(of.solid != nullptr && of.point.normal != of.point.geometric) {
    if (of.solid != nullptr && of.side() == Side::solid) wo.z = -wo.z;
}

glm::vec3 PathIntegrator::PathVertex::mirrored(const glm::vec3& direction) const {
    const glm::vec3 surface(path->point.geometric);
    return direction - 2.0f * glm::dot(direction, surface) * surface;
}

float PathIntegrator::PathVertex::bentPdf(const glm::vec3& direction) const {
    const Brdf& brdf = *path->point.brdf;
    if (!(glm::dot(glm::dvec3(direction), path->point.geometric) > 0.0)) return 0.0f;
    return brdf.pdf(wo, frame.toLocal(direction)) + brdf.pdf(wo, frame.toLocal(mirrored(direction)));
}

void PathIntegrator::sampleLights(const PathVertex& vertex, Sampler& sampler, ShadowRays& shadow_rays) const {
    const Path& path = *vertex.path;
    const SurfacePoint& point = path.point;
    const glm::vec3& wo = vertex.wo;
    for (const auto& light : scene_.lights) {
        const glm::vec2 draw = light->hasExtent() ? sampler.next2D() : glm::vec2(0.0f);
        const std::optional<LightSample> sample = light->sample(point.position, draw);
        if (!sample) continue;
        const glm::vec3 wi = vertex.frame.toLocal(sample->direction);
        const float bent = vertex.bent ? vertex.bentPdf(sample->direction) : 0.0f;
        const Color reflected = vertex.bent ? Color(bent) : point.brdf->eval(wo, wi) * std::max(wi.z, 0.0f);
        Color value = path.throughput * reflected * sample->light;
        if (sample->pdf > 0.0f)
            value *= powerHeuristic(sample->pdf, vertex.bent ? bent : point.brdf->pdf(wo, wi)) / sample->pdf;
        if (!(maxComponent(value) > 0.0f)) continue;
        trace::Ray& ray = shadow_rays.add(value, path.pixel);
        ray = surfaces_.leave(point, sample->direction);
        ray.t_max = sample->distance;
    }
}

std::size_t PathIntegrator::raysAVertex() const {
    const int strategies = scene_.environment->strategies();
    return static_cast<std::size_t>(bed_sampler_ ? std::max(strategies, bed_sampler_->strategies()) : strategies) +
           scene_.lights.size();
}

Color PathIntegrator::hitLights(const trace::Ray& ray, double t, float pdf) const {
    Color sum(0.0f);
    for (const Light* light : extended_lights_) {
        const std::optional<LightHit> hit = light->intersect(ray);
        if (hit && hit->t <= t) sum += hit->radiance * powerHeuristic(pdf, hit->pdf);
    }
    return sum;
}

/// Adds one shadow ray for each strategy. The BRDF's own sample, which scatter() draws, completes them.
void PathIntegrator::sampleEnvironment(const Group& group, std::span<const PathVertex> vertices,
                                       std::span<Sampler> samplers, ShadowRays& shadow_rays, LightBatch& batch) const {
    const std::size_t count = group.members.size();
    if (count == 0) return;
    batch.resize(count);
    batch.u.resize(count);
    batch.pixels.resize(count);
    for (std::size_t k = 0; k < count; ++k) {
        const PathVertex& vertex = vertices[group.members[k]];
        batch.pixels[k] = vertex.path->pixel;
        batch.normals[k] = vertex.frame.z;
    }
    for (int strategy = 0; strategy < group.light->strategies(); ++strategy) {
        next2DStream(samplers, batch.pixels, batch.u);
        group.light->sampleStream(strategy, batch.u, batch.normals, batch.samples);
        BrdfBatch& reflections = batch.reflections;
        std::vector<std::size_t>& lit = batch.lit;
        reflections.clear();
        lit.clear();
        for (std::size_t k = 0; k < count; ++k) {
            const PathVertex& vertex = vertices[group.members[k]];
            const EnvironmentSample& light = batch.samples[k];
            const glm::vec3 wi = vertex.frame.toLocal(light.direction);
            if (!(light.pdf > 0.0f && (wi.z > 0.0f || vertex.bent))) continue;
            lit.push_back(k);
            reflections.addPair(*vertex.path->point.brdf, vertex.wo, wi);
        }
        reflections.eval();
        for (std::size_t m = 0; m < lit.size(); ++m) {
            const std::size_t k = lit[m];
            const PathVertex& vertex = vertices[group.members[k]];
            const EnvironmentSample& light = batch.samples[k];
            const float density = vertex.bent ? vertex.bentPdf(light.direction) : reflections.densities[m];
            const float weight = balanceHeuristic(light.pdf, group.share * density);
            const Color reflected = vertex.bent ? Color(1.0f) : reflections.values[m];
            const float cosine = vertex.bent ? density : reflections.wi(m).z;
            const Color value = vertex.path->throughput * reflected * (cosine * weight / light.pdf) * light.radiance;
            if (!(maxComponent(value) > 0.0f)) continue;
            surfaces_.leave(vertex.path->point, light.direction, shadow_rays.add(value, vertex.path->pixel));
        }
    }
}

bool PathIntegrator::scatter(PathVertex& vertex, const BrdfSample& next, Bounce& bounce) const {
    Path& path = *vertex.path;
    if (!(next.pdf > 0.0f)) return false;
    path.throughput *= next.f * (next.wi.z / next.pdf);
    if (!(maxComponent(path.throughput) > 0.0f)) return false;
    bounce.from = &vertex;
    bounce.direction = vertex.frame.toWorld(next.wi);
    surfaces_.leave(path.point, bounce.direction, bounce.ray);
    bounce.pdf = next.pdf;
    bounce.escaped = hitLights(bounce.ray, kFar, next.pdf);
    bounce.inside = path.inside;
    return true;
}

bool PathIntegrator::scatterThrough(PathVertex& vertex, const glm::vec2& lobe_draw, const glm::vec2& draw,
                                    Bounce& bounce) const {
    Path& path = *vertex.path;
    const std::optional<InterfaceSample> next = path.solid->surface().sample(path.side(), vertex.wo, lobe_draw, draw);
    if (!next) return false;
    const bool out = next->side == Side::air;
    glm::vec3 direction = vertex.frame.toWorld({next->wi.x, next->wi.y, out ? next->wi.z : -next->wi.z});
    // With smooth normals it may be on the wrong side of the real surface.
    if ((glm::dot(glm::dvec3(direction), path.point.geometric) > 0.0) != out) direction = vertex.mirrored(direction);
    bounce.from = &vertex;
    bounce.direction = direction;
    bounce.pdf = vertex.bent && out ? vertex.bentPdf(direction) : next->pdf;
    if (out) {
        bounce.ray = surfaces_.leave(path.point, direction);
        bounce.escaped = hitLights(bounce.ray, kFar, bounce.pdf);
    } else {
        bounce.ray = surfaces_.enter(path.point, direction);
        bounce.inside = path.side() == Side::solid && path.inside != nullptr ? path.inside : path.solid;
    }
    return true;
}

void PathIntegrator::evalEscaped(const Group& group, std::span<Bounce> bounces, LightBatch& batch) const {
    const std::size_t count = group.members.size();
    if (count == 0) return;
    batch.resize(count);
    batch.directions.resize(count);
    for (std::size_t k = 0; k < count; ++k) {
        const Bounce& bounce = bounces[group.members[k]];
        batch.directions[k] = bounce.direction;
        batch.normals[k] = bounce.from->frame.z;
    }
    group.light->evalStream(batch.directions, batch.normals, batch.samples);
    for (std::size_t k = 0; k < count; ++k) {
        Bounce& bounce = bounces[group.members[k]];
        const float own = group.share * bounce.pdf;
        bounce.escaped += batch.samples[k].radiance * balanceHeuristic(own, batch.samples[k].pdf);
    }
}

void PathIntegrator::addUnoccluded(ShadowRays& shadow_rays, trace::Tracer& tracer, std::span<Color> sums) const {
    std::vector<std::uint8_t> blocked(shadow_rays.rays.size());
    surfaces_.occluded(shadow_rays.rays, tracer, blocked);
    for (std::size_t k = 0; k < blocked.size(); ++k)
        if (blocked[k] == 0) sums[shadow_rays.pixel[k]] += shadow_rays.light[k];
}

float PathIntegrator::fadeAt(const SurfacePoint& point) const {
    return std::isfinite(point.t) ? surfaces_.fade(point) : 1.0f;
}

void PathIntegrator::scatterAll(std::span<PathVertex> vertices, std::span<const glm::vec2> lobe_draws,
                                std::span<const glm::vec2> brdf_draws, std::span<Color> sums,
                                std::vector<Bounce>& bounces, std::vector<Walker>& walkers, BrdfBatch& batch) const {
    batch.clear();
    for (std::size_t n = 0; n < vertices.size(); ++n)
        if (vertices[n].path->solid == nullptr)
            batch.addDraw(*vertices[n].path->point.brdf, vertices[n].wo, lobe_draws[n].x, brdf_draws[n]);
    batch.sample();
    std::size_t drawn = 0;
    for (std::size_t n = 0; n < vertices.size(); ++n) {
        PathVertex& vertex = vertices[n];
        Bounce& bounce = bounces.emplace_back();
        if (!(vertex.path->solid != nullptr ? scatterThrough(vertex, lobe_draws[n], brdf_draws[n], bounce)
                                            : scatter(vertex, batch.samples[drawn++], bounce))) {
            bounces.pop_back();
            continue;
        }
        Path& path = *vertex.path;
        if (bounce.inside != nullptr) {
            walkers.emplace_back(path, bounce.ray, bounce.inside);
            bounces.pop_back();
            continue;
        }
        // It stands for all light from other surfaces, too: those that the path meets later add none of it.
        if (!path.ambient) sums[path.pixel] += path.throughput * scene_.ambient;
        path.ambient = true;
    }
}

void PathIntegrator::seenStream(std::span<const trace::Ray> rays, std::span<const SurfacePoint> points,
                                std::span<Sampler> samplers, trace::Tracer& tracer, RayCounts& counts,
                                std::span<Pixel> pixels) const {
    std::vector<Color> sums(rays.size(), Color(0.0f));
    std::vector<Color> bare(scene_.catcher || bare_bed_ ? rays.size() : 0, Color(0.0f));
    follow(rays, points, {samplers, sums, bare, nullptr}, tracer, counts);
    if (bare_bed_) reduceBedNoise(points, bare, sums);
    scene_.catcher ? catchShadows(points, sums, bare, pixels) : blendBackdrop(rays, points, sums, pixels);
}

void PathIntegrator::followDeep(std::span<const trace::Ray> rays, std::span<const SurfacePoint> points,
                                std::span<Sampler> samplers, trace::Tracer& tracer,
                                std::vector<DeepVertex>& vertices) const {
    std::vector<Color> sums(rays.size(), Color(0.0f));
    const std::size_t first = vertices.size();
    RayCounts ignored;
    follow(rays, points, {samplers, sums, {}, &vertices}, tracer, ignored);
    // They have what the path had brought before.
    for (DeepVertex& vertex : std::span(vertices).subspan(first)) vertex.light = sums[vertex.path] - vertex.light;
}

void PathIntegrator::follow(std::span<const trace::Ray> rays, std::span<const SurfacePoint> points,
                            const Stream& stream, trace::Tracer& tracer, RayCounts& counts) const {
    const auto& [samplers, sums, bare, deep] = stream;
    std::vector<Path> paths;
    paths.reserve(rays.size());
    for (std::size_t n = 0; n < rays.size(); ++n)
        if (fadeAt(points[n]) < 1.0f)
            addPath({Color(1.0f), n, 0, 0}, points[n], rays[n].direction, nullptr, stream, paths);

    ShadowRays shadow_rays;
    // Bounces of the last step. They matter only if they hit nothing, so an occlusion test is enough.
    ShadowRays escaped_rays;
    LightBatch batch;
    std::array<Group, 2> groups{Group{scene_.environment.get(), 1.0f, {}}, Group{bed_sampler_.get(), kBedShare, {}}};
    std::vector<PathVertex> vertices;
    std::vector<glm::vec2> lobe_draws;
    std::vector<glm::vec2> brdf_draws;
    std::vector<Bounce> bounces;
    std::vector<trace::Ray> bounce_rays;
    std::vector<SurfacePoint> hits;
    std::vector<Path> next_paths;
    std::vector<Walker> walkers;
    const int steps = walk_ ? kMostSurfaces : bounces_;
    for (int step = 1; step <= steps && !paths.empty(); ++step) {
        // Where something is translucent, light may come through it to the last opaque surface.
        const bool last = step == bounces_ && !walk_;
        shadow_rays.clear();
        escaped_rays.clear();
        vertices.clear();
        bounces.clear();
        vertices.reserve(paths.size());
        bounces.reserve(paths.size());
        shadow_rays.reserve(paths.size() * raysAVertex());
        for (Path& path : paths) vertices.emplace_back(path);
        // Every step draws the same dimensions in the same order, so that each dimension keeps its stratification.
        gatherGroups(groups, vertices, [](const PathVertex& vertex) { return vertex.path->point.bed; });
        for (const Group& group : groups) sampleEnvironment(group, vertices, samplers, shadow_rays, batch);
        batch.pixels.clear();
        for (const PathVertex& vertex : vertices) {
            sampleLights(vertex, samplers[vertex.path->pixel], shadow_rays);
            batch.pixels.push_back(vertex.path->pixel);
        }
        lobe_draws.resize(vertices.size());
        brdf_draws.resize(vertices.size());
        next2DStream(samplers, batch.pixels, lobe_draws);
        next2DStream(samplers, batch.pixels, brdf_draws);
        scatterAll(vertices, lobe_draws, brdf_draws, sums, bounces, walkers, batch.reflections);
        gatherGroups(groups, bounces, [](const Bounce& bounce) { return bounce.from->path->point.bed; });
        for (const Group& group : groups) evalEscaped(group, bounces, batch);
        if (step == 1 && !bare.empty()) addBare(points, shadow_rays, bounces, bare);
        const auto dark = [](const Bounce& bounce) { return !(maxComponent(bounce.escaped) > 0.0f); };
        const bool only_escape = last && extended_lights_.empty();
        if (only_escape) {
            for (const Bounce& bounce : bounces) {
                if (dark(bounce)) continue;
                const Path& path = *bounce.from->path;
                escaped_rays.add(path.throughput * bounce.escaped, path.pixel) = bounce.ray;
            }
        } else if (last) {
            std::erase_if(bounces, dark);
        }
        counts.shadow += shadow_rays.rays.size();
        counts.bounce += only_escape ? escaped_rays.rays.size() : bounces.size();
        addUnoccluded(shadow_rays, tracer, sums);
        addUnoccluded(escaped_rays, tracer, sums);
        if (only_escape) break;

        bounce_rays.clear();
        bounce_rays.reserve(bounces.size());
        for (const Bounce& bounce : bounces) bounce_rays.push_back(bounce.ray);
        hits.resize(bounce_rays.size());
        surfaces_.nearestBounced(bounce_rays, tracer, hits);
        continuePaths(bounces, hits, stream, next_paths);
        if (!walkers.empty()) walk(walkers, stream, tracer, counts, next_paths);
        paths.swap(next_paths);
    }
}

void PathIntegrator::continuePaths(std::span<const Bounce> bounces, std::span<const SurfacePoint> hits,
                                   const Stream& stream, std::vector<Path>& next_paths) const {
    next_paths.clear();
    next_paths.reserve(bounces.size());
    for (std::size_t k = 0; k < bounces.size(); ++k) {
        const Path& path = *bounces[k].from->path;
        Color& sum = stream.sums[path.pixel];
        if (!std::isfinite(hits[k].t)) {
            sum += path.throughput * bounces[k].escaped;
            continue;
        }
        // Lights occlude nothing, so one may lie in front of the surface.
        sum += path.throughput * hitLights(bounces[k].ray, hits[k].t, bounces[k].pdf);
        addPath(path, hits[k], bounces[k].ray.direction, nullptr, stream, next_paths);
    }
}

void PathIntegrator::walk(std::vector<Walker>& walkers, const Stream& stream, trace::Tracer& tracer, RayCounts& counts,
                          std::vector<Path>& next_paths) const {
    std::vector<Arrival> arrivals;
    walk_->walk(walkers, stream.samplers, tracer, counts, arrivals);
    for (Arrival& arrival : arrivals) {
        Walker& walker = arrival.walker;
        // At a surface of little absorption a path may be reflected inwards again and again.
        if (!survives(walker.throughput, stream.samplers[walker.pixel])) continue;
        addPath(walker, arrival.point, walker.ray.direction, walker.solid, stream, next_paths);
    }
}

void PathIntegrator::blendBackdrop(std::span<const trace::Ray> rays, std::span<const SurfacePoint> points,
                                   std::span<const Color> sums, std::span<Pixel> pixels) const {
    std::vector<trace::Ray> backdrop_rays;
    for (std::size_t n = 0; n < rays.size(); ++n)
        if (fadeAt(points[n]) > 0.0f) backdrop_rays.push_back(rays[n]);
    std::vector<Color> behind(backdrop_rays.size(), Color(0.0f));
    const bool backdrop = surfaces_.backdrop(backdrop_rays, behind);
    for (std::size_t n = 0, faded = 0; n < rays.size(); ++n) {
        const float fade = fadeAt(points[n]);
        Color color = (1.0f - fade) * sums[n];
        if (fade > 0.0f) color += fade * behind[faded++];
        pixels[n] = std::isfinite(points[n].t) || backdrop ? Pixel{color, 1.0f} : Pixel{};
    }
}

}  // namespace stratum::shade
