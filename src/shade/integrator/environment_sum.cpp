#include "shade/integrator/environment_sum.h"

#include "shade/frame.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace stratum::shade {

EnvironmentSum::EnvironmentSum(const SceneDescription& scene, const trace::Intersector& print, int rows)
    : Integrator(scene, print), scene_(scene) {
    // Sampled more finely than any likely map, so that the mean includes a sun of one texel.
    const int cuts = std::max(4, 2048 / rows);
    const auto directionAt = [&](double row, double column) {
        const double theta = std::numbers::pi * row / rows;
        const double phi = std::numbers::pi * column / rows;
        return glm::dvec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
    };
    for (int row = 0; row < rows; ++row) {
        const double solid_angle =
            (std::cos(std::numbers::pi * row / rows) - std::cos(std::numbers::pi * (row + 1) / rows)) *
            std::numbers::pi / rows;
        for (int column = 0; column < 2 * rows; ++column) {
            glm::dvec3 sum(0.0);
            double weight = 0.0;
            for (int a = 0; a < cuts; ++a) {
                const double r = row + (a + 0.5) / cuts;
                const double sine = std::sin(std::numbers::pi * r / rows);
                for (int b = 0; b < cuts; ++b) {
                    const glm::vec3 d(directionAt(r, column + (b + 0.5) / cuts));
                    sum += sine * glm::dvec3(scene.environment->radiance(d));
                    weight += sine;
                }
            }
            const Color power(sum * (solid_angle / weight));
            if (maxComponent(power) > 0.0f) cells_.push_back({glm::vec3(directionAt(row + 0.5, column + 0.5)), power});
        }
    }
}

Pixel EnvironmentSum::seen(const trace::Ray& ray, const SurfacePoint* first, TraceContext& context) const {
    Color behind(0.0f);
    if (first == nullptr) return surfaces_.backdrop(ray, behind) ? Pixel{behind, 1.0f} : Pixel{};
    const SurfacePoint& point = *first;
    const float fade = surfaces_.fade(point);
    if (fade > 0.0f) surfaces_.backdrop(ray, behind);
    if (fade >= 1.0f) return {behind, 1.0f};
    const Frame frame{glm::vec3(point.normal)};
    const glm::vec3 wo = frame.toLocal(glm::vec3(-ray.direction));
    // All shadow rays of a point are traced as one stream.
    std::vector<trace::Ray> shadow_rays;
    std::vector<Color> values;
    const auto add = [&](const glm::vec3& direction, double distance, const Color& power) {
        const glm::vec3 wi = frame.toLocal(direction);
        if (!(wi.z > 0.0f)) return;
        const Color value = point.brdf->eval(wo, wi) * wi.z * power;
        if (!(maxComponent(value) > 0.0f)) return;
        trace::Ray shadow_ray = surfaces_.leave(point, direction);
        shadow_ray.t_max = distance;
        shadow_rays.push_back(shadow_ray);
        values.push_back(value);
    };
    for (const Cell& cell : cells_) add(cell.direction, std::numeric_limits<double>::infinity(), cell.power);
    for (const auto& light : scene_.lights)
        if (const auto s = light->sample(point.position, {0.5f, 0.5f}))
            add(s->direction, s->distance, s->light / (s->pdf > 0.0f ? s->pdf : 1.0f));
    context.rays.shadow += shadow_rays.size();
    std::vector<std::uint8_t> blocked(shadow_rays.size());
    surfaces_.occluded(shadow_rays, context.tracer, blocked);
    Color sum(0.0f);
    for (std::size_t k = 0; k < shadow_rays.size(); ++k)
        if (blocked[k] == 0) sum += values[k];
    return {(1.0f - fade) * sum + fade * behind, 1.0f};
}

}  // namespace stratum::shade
