#include "shade/scene/surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace stratum::shade {

Surfaces::Surfaces(const SceneDescription& scene, const trace::Intersector& print)
    : scene_(scene), offset_(print.surfaceOffset()), only_(scene.material) {
    if (!scene.bed) return;
    contact_ = scene.bed;
    contact_->z += 0.05 * print.voxelSize();
}

void Surfaces::onPrint(const trace::Ray& ray, const trace::Hit& hit, Gloss gloss, trace::Tracer& tracer,
                       SurfacePoint& point) const {
    point.position = hit.position;
    point.t = hit.t;
    point.bed = false;
    point.labels.fill(-1.0f);
    const ObjectMaterial& object = hit.object < scene_.objects.size() ? scene_.objects[hit.object] : only_;
    const Material& material = object.single() ? object.only() : object.of(tracer.attribute(hit, object.attribute()));
    point.brdf = material.by_place ? &material.brdf->at(scene_.mm_per_unit * hit.position) : material.brdf.get();
    point.albedo = material.albedo;
    point.grain = glm::vec3(0.0f);
    if (material.undirected != nullptr) {
        if (gloss == Gloss::directed) point.grain = glm::vec3(tracer.grain(hit));
        if (point.grain == glm::vec3(0.0f)) point.brdf = material.undirected;
    }
    for (std::size_t n = 0; n < kLabels; ++n)
        if (scene_.labels[n])
            if (const auto value = tracer.attribute(hit, *scene_.labels[n])) point.labels[n] = value->x;
    const double facing = glm::dot(hit.normal, ray.direction);
    // A normal that is no number (a gradient of zero) is replaced here, once: the surface then faces the ray.
    if (!std::isfinite(facing) || !(glm::dot(hit.normal, hit.normal) > 0.5))
        point.normal = -ray.direction;
    else
        point.normal = facing > 0.0 ? -hit.normal : hit.normal;
    point.geometric = point.normal;
    point.from_inside = facing > 0.0;
    if (scene_.smooth_normals) {
        const glm::dvec3 smooth = tracer.shadingNormal(hit);
        const glm::dvec3 facing_us = facing > 0.0 ? -smooth : smooth;
        // A smooth normal that faces away from the viewer would render black: near silhouettes the geometric one is
        // used.
        if (glm::dot(facing_us, ray.direction) < 0.0) point.normal = facing_us;
    }
}

void Surfaces::onBed(const Bed& bed, const trace::Ray& ray, double t, SurfacePoint& point) {
    point.position = ray.origin + t * ray.direction;
    point.position.z = bed.z;
    point.t = t;
    const glm::dvec2 xy(point.position.x, point.position.y);
    const BedTexture::Finish& finish = bed.texture.at(xy);
    point.brdf = finish.brdf.get();
    point.albedo = finish.albedo;
    point.grain = glm::vec3(0.0f);
    constexpr glm::dvec3 kUp(0.0, 0.0, 1.0);
    point.normal = point.geometric = kUp;
    if (bed.texture.bumpy()) {
        const glm::dvec3 bump = bed.texture.normal(xy);
        // As on the print: a normal that faces away from the viewer would render black.
        if (glm::dot(bump, ray.direction) < 0.0) point.normal = bump;
    }
    point.bed = true;
    point.from_inside = false;
    point.labels.fill(-1.0f);
}

bool Surfaces::nearest(const trace::Ray& ray, trace::Tracer& tracer, SurfacePoint& point) const {
    trace::Ray limited = ray;
    const std::optional<double> bed = scene_.bed ? scene_.bed->intersect(ray) : std::nullopt;
    if (bed) limited.t_max = *bed;
    trace::Hit hit;
    const bool print = tracer.intersect(limited, hit);
    if (print)
        onPrint(ray, hit, Gloss::directed, tracer, point);
    else if (bed)
        onBed(*scene_.bed, ray, *bed, point);
    return print || bed;
}

void Surfaces::nearest(std::span<trace::Ray> rays, trace::Tracer& tracer, std::span<SurfacePoint> points) const {
    nearest(rays, scene_.bed ? &*scene_.bed : nullptr, Gloss::directed, tracer, points);
}

void Surfaces::nearestBounced(std::span<trace::Ray> rays, trace::Tracer& tracer, std::span<SurfacePoint> points) const {
    nearest(rays, scene_.bed ? &*scene_.bed : nullptr, Gloss::undirected, tracer, points);
}

void Surfaces::nearestInside(std::span<trace::Ray> rays, trace::Tracer& tracer, std::span<SurfacePoint> points) const {
    nearest(rays, contact_ ? &*contact_ : nullptr, Gloss::undirected, tracer, points);
}

void Surfaces::nearest(std::span<trace::Ray> rays, const Bed* bed, Gloss gloss, trace::Tracer& tracer,
                       std::span<SurfacePoint> points) const {
    // Kept by the thread: fresh memory for every stream would cost as much as tracing it.
    static thread_local std::vector<trace::Hit> hits;
    hits.resize(rays.size());
    // The hits may be those of an earlier scene, and intersectors of one object or without parts don't set these
    // fields.
    for (trace::Hit& hit : hits) hit.object = hit.part = 0;
    constexpr double kNone = std::numeric_limits<double>::infinity();
    static thread_local std::vector<double> beds;
    if (bed != nullptr) {
        beds.resize(rays.size());
        for (std::size_t n = 0; n < rays.size(); ++n) {
            beds[n] = bed->intersect(rays[n]).value_or(kNone);
            rays[n].t_max = std::min(rays[n].t_max, beds[n]);
        }
    }
    tracer.intersectStream(rays, hits);
    for (std::size_t n = 0; n < rays.size(); ++n) {
        if (std::isfinite(hits[n].t))
            onPrint(rays[n], hits[n], gloss, tracer, points[n]);
        else if (bed != nullptr && beds[n] < kNone)
            onBed(*bed, rays[n], beds[n], points[n]);
        else
            points[n].t = kNone;
    }
}

bool Surfaces::occluded(const trace::Ray& ray, trace::Tracer& tracer) const {
    return (scene_.bed && scene_.bed->blocks(ray)) || tracer.occluded(ray);
}

void Surfaces::occluded(std::span<trace::Ray> rays, trace::Tracer& tracer, std::span<std::uint8_t> blocked) const {
    if (!scene_.bed) return tracer.occludedStream(rays, blocked);
    // Rays that hit the bed are not traced through the print: the others move up to the front. Half of the rays go
    // down, at random, so there is no branch. Kept by the thread, as in nearest().
    static thread_local std::vector<std::size_t> ray_of;
    static thread_local std::vector<std::uint8_t> answers;
    ray_of.resize(rays.size());
    std::size_t others = 0;
    for (std::size_t n = 0; n < rays.size(); ++n) {
        const bool hit = scene_.bed->blocks(rays[n]);
        blocked[n] = hit ? 1 : 0;
        rays[others] = rays[n];
        ray_of[others] = n;
        others += hit ? 0 : 1;
    }
    answers.resize(others);
    tracer.occludedStream(rays.first(others), answers);
    for (std::size_t k = 0; k < others; ++k) blocked[ray_of[k]] = answers[k];
}

float Surfaces::fade(const SurfacePoint& point) const {
    return point.bed && scene_.backdrop ? static_cast<float>(scene_.bed->fade(point.position)) : 0.0f;
}

bool Surfaces::backdrop(const trace::Ray& ray, Color& radiance) const {
    return backdrop(std::span(&ray, 1), std::span(&radiance, 1));
}

bool Surfaces::backdrop(std::span<const trace::Ray> rays, std::span<Color> radiances) const {
    if (scene_.backdrop) {
        for (std::size_t n = 0; n < rays.size(); ++n)
            radiances[n] = scene_.backdrop->radiance(glm::vec3(rays[n].direction));
        return true;
    }
    if (scene_.transparent || !scene_.environment->visible()) return false;
    std::vector<glm::vec3> directions;
    directions.reserve(rays.size());
    for (const trace::Ray& ray : rays) directions.emplace_back(ray.direction);
    scene_.environment->radianceStream(directions, radiances);
    return true;
}

}  // namespace stratum::shade
