#include "shade/integrator/phong.h"

#include "shade/light/light.h"

#include <glm/geometric.hpp>

#include <cmath>

namespace stratum::shade {

PhongIntegrator::PhongIntegrator(const SceneDescription& scene, const trace::Intersector& print,
                                 const PhongOptions& options)
    : RayIntegrator(scene, print), options_(options), lights_(scene.lights), ambient_(scene.ambient) {
    if (!lights_.empty() || maxComponent(ambient_) > 0.0f) return;
    ambient_ = Color(0.2f);
    const glm::dvec3 to_light = scene.camera.up() - 0.7 * scene.camera.right() - scene.camera.forward();
    lights_.push_back(std::make_shared<DirectionalLight>(glm::vec3(glm::normalize(to_light)), Color(0.8f)));
}

/// I of the model, without the mirror term and without the base color.
Color PhongIntegrator::local(const SurfacePoint& point, const glm::vec3& view, TraceContext& context) const {
    const glm::vec3 n(point.normal);
    Color sum = options_.ambient * ambient_;
    for (const auto& light : lights_) {
        const std::optional<LightSample> sample = light->sample(point.position, {0.5f, 0.5f});
        if (!sample) continue;
        const float facing = glm::dot(n, sample->direction);
        if (!(facing > 0.0f)) continue;
        Color intensity = sample->light / (sample->pdf > 0.0f ? sample->pdf : 1.0f);
        if (std::isfinite(sample->distance) && !light->hasExtent())
            intensity *= static_cast<float>(sample->distance * sample->distance);
        const glm::vec3 mirrored = 2.0f * facing * n - sample->direction;
        const float gloss = std::pow(std::max(glm::dot(mirrored, view), 0.0f), options_.shininess);
        trace::Ray ray = surfaces_.leave(point, sample->direction);
        ray.t_max = sample->distance;
        ++context.rays.shadow;
        if (!surfaces_.occluded(ray, context.tracer))
            sum += intensity * (options_.diffuse * facing + options_.specular * gloss);
    }
    return sum;
}

Pixel PhongIntegrator::seen(const trace::Ray& camera_ray, const SurfacePoint* first, TraceContext& context) const {
    constexpr int kDepth = 5;
    trace::Ray ray = camera_ray;
    Color sum(0.0f);
    float share = 1.0f;
    for (int depth = 0;; ++depth) {
        Color behind(0.0f);
        SurfacePoint point;
        bool met = first != nullptr;
        if (depth == 0) {
            if (met) point = *first;
        } else {
            ++context.rays.bounce;
            met = surfaces_.nearest(ray, context.tracer, point);
        }
        if (!met) {
            const bool backdrop = surfaces_.backdrop(ray, behind);
            if (depth == 0) return backdrop ? Pixel{behind, 1.0f} : Pixel{};
            return {sum + share * behind, 1.0f};
        }
        const float fade = surfaces_.fade(point);
        if (fade > 0.0f) surfaces_.backdrop(ray, behind);
        const glm::vec3 view(-ray.direction);
        const float mirror = point.bed ? 0.0f : options_.reflective;
        const Color here = point.albedo * local(point, view, context);
        sum += share * ((1.0f - fade) * (1.0f - mirror) * here + fade * behind);
        share *= (1.0f - fade) * mirror;
        if (!(share > 0.0f) || depth == kDepth) return {sum, 1.0f};
        const glm::vec3 n(point.normal);
        ray = surfaces_.leave(point, 2.0f * glm::dot(n, view) * n - view);
    }
}

}  // namespace stratum::shade
