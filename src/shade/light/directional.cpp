#include "shade/light/directional.h"

#include "shade/camera/sampling.h"
#include "shade/frame.h"

#include <cmath>
#include <numbers>

namespace stratum::shade {

std::optional<LightSample> DirectionalLight::sample(const glm::dvec3&, const glm::vec2&) const {
    LightSample result;
    result.direction = to_light_;
    result.light = irradiance_;
    return result;
}

SunLight::SunLight(const glm::vec3& to_light, const Color& irradiance, float diameter) : to_light_(to_light) {
    const double half = 0.5 * static_cast<double>(diameter) * std::numbers::pi / 180.0;
    const double s = std::sin(0.5 * half);
    lift_ = 2.0 * s * s;
    pdf_ = static_cast<float>(1.0 / (2.0 * std::numbers::pi * lift_));
    // Integral of the cosine over the cap.
    radiance_ = irradiance / static_cast<float>(std::numbers::pi * std::sin(half) * std::sin(half));
}

std::optional<LightSample> SunLight::sample(const glm::dvec3&, const glm::vec2& u) const {
    // Uniform on the spherical cap by the disc below it; preserves adjacency.
    const glm::dvec2 d(toDisc(u));
    const double r2 = glm::dot(d, d);
    const double drop = r2 * lift_;
    const double s = std::sqrt(lift_ * (2.0 - drop));
    LightSample result;
    const Frame frame(to_light_);
    result.direction = glm::normalize(frame.toWorld(glm::vec3(s * d.x, s * d.y, 1.0 - drop)));
    result.light = radiance_;
    result.pdf = pdf_;
    return result;
}

std::optional<LightHit> SunLight::intersect(const trace::Ray& ray) const {
    // |a - b|^2 = 2 (1 - cos) is more accurate than the dot product.
    const glm::dvec3 apart = ray.direction - glm::dvec3(to_light_);
    if (0.5 * glm::dot(apart, apart) > lift_) return std::nullopt;
    return LightHit{std::numeric_limits<double>::infinity(), radiance_, pdf_};
}

}  // namespace stratum::shade
