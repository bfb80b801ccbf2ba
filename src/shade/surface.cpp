#include "shade/surface.h"

#include <glm/geometric.hpp>

#include <cmath>

namespace stratum::shade {

Surfaces::Surfaces(const SceneDescription& scene, const march::Intersector& print)
    : scene_(scene), offset_(print.surfaceOffset()), paper_(scene.bed ? scene.bed->albedo : Color(0.0f)) {}

bool Surfaces::nearest(const march::Ray& ray, march::Tracer& tracer, SurfacePoint& point) const {
    march::Ray limited = ray;
    const std::optional<double> bed = scene_.bed ? scene_.bed->intersect(ray) : std::nullopt;
    if (bed) limited.t_max = *bed;
    march::Hit hit;
    if (tracer.intersect(limited, hit)) {
        point.position = hit.position;
        point.t = hit.t;
        point.brdf = scene_.material.get();
        point.bed = false;
        const double facing = glm::dot(hit.normal, ray.direction);
        // A normal that is no number (a gradient of zero) is replaced here, once: the surface then faces the ray.
        if (!std::isfinite(facing) || !(glm::dot(hit.normal, hit.normal) > 0.5))
            point.normal = -ray.direction;
        else
            point.normal = facing > 0.0 ? -hit.normal : hit.normal;
        return true;
    }
    if (!bed) return false;
    point.position = ray.origin + *bed * ray.direction;
    point.position.z = scene_.bed->z;
    point.normal = {0.0, 0.0, 1.0};
    point.t = *bed;
    point.brdf = &paper_;
    point.bed = true;
    return true;
}

bool Surfaces::occluded(const march::Ray& ray, march::Tracer& tracer) const {
    return (scene_.bed && scene_.bed->intersect(ray)) || tracer.occluded(ray);
}

march::Ray Surfaces::leave(const SurfacePoint& point, const glm::vec3& direction) const {
    march::Ray ray;
    ray.origin = point.position + offset_ * point.normal;
    ray.direction = glm::normalize(glm::dvec3(direction));
    return ray;
}

float Surfaces::fade(const SurfacePoint& point) const {
    return point.bed && scene_.backdrop ? static_cast<float>(scene_.bed->fade(point.position)) : 0.0f;
}

bool Surfaces::backdrop(const march::Ray& ray, Color& radiance) const {
    if (scene_.backdrop)
        radiance = scene_.backdrop->radiance(glm::vec3(ray.direction));
    else if (scene_.environment->visible())
        radiance = scene_.environment->radiance(glm::vec3(ray.direction));
    else
        return false;
    return true;
}

}  // namespace stratum::shade
