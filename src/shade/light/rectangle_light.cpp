#include "shade/light/rectangle_light.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::shade {

/// The spherical rectangle from a point, in the names of the paper.
struct RectangleLight::View {
    double x0, x1, y0, y1, z0;  // of the corners, about the point; z0 < 0, or 0 in its plane
    double side;                // 1, or -1 if the point is behind it: then z points the other way
    double b0, b1, k;
    double solid_angle;
};

RectangleLight::RectangleLight(const glm::dvec3& center, const glm::dvec3& half_u, const glm::dvec3& half_v,
                               const Color& radiance)
    : center_(center),
      x_(glm::normalize(half_u)),
      z_(glm::normalize(glm::cross(half_u, half_v))),
      half_x_(glm::length(half_u)),
      half_y_(glm::length(half_v)),
      radiance_(radiance) {
    y_ = glm::cross(z_, x_);
}

RectangleLight::View RectangleLight::viewFrom(const glm::dvec3& point) const {
    const glm::dvec3 d = center_ - point;
    View v{};
    v.x0 = glm::dot(d, x_) - half_x_;
    v.x1 = v.x0 + 2.0 * half_x_;
    v.y0 = glm::dot(d, y_) - half_y_;
    v.y1 = v.y0 + 2.0 * half_y_;
    const double z = glm::dot(d, z_);
    v.side = z > 0.0 ? -1.0 : 1.0;
    v.z0 = -std::abs(z);
    if (!(v.z0 < 0.0)) return v;
    // z of the unit normals of the four sides, and the inner angles between them.
    const auto across = [&v](double a) { return -a / std::hypot(v.z0, a); };
    const double n0 = across(v.y0);
    const double n1 = -across(v.x1);
    const double n2 = -across(v.y1);
    const double n3 = across(v.x0);
    const auto angle = [](double a, double b) { return std::acos(std::clamp(-a * b, -1.0, 1.0)); };
    const double g0 = angle(n0, n1);
    const double g1 = angle(n1, n2);
    const double g2 = angle(n2, n3);
    const double g3 = angle(n3, n0);
    v.b0 = n0;
    v.b1 = n2;
    v.k = 2.0 * std::numbers::pi - g2 - g3;
    v.solid_angle = g0 + g1 - v.k;
    return v;
}

std::optional<LightSample> RectangleLight::sample(const glm::dvec3& point, const glm::vec2& u) const {
    const View v = viewFrom(point);
    if (!(v.z0 < 0.0)) return std::nullopt;
    double x = 0.0;
    double y = 0.0;
    double pdf = 0.0;
    if (v.solid_angle > 1e-7) {
        const double au = static_cast<double>(u.x) * v.solid_angle + v.k;
        const double fu = (std::cos(au) * v.b0 - v.b1) / std::sin(au);
        const double cu = std::clamp(std::copysign(1.0 / std::sqrt(fu * fu + v.b0 * v.b0), fu), -1.0, 1.0);
        x = std::clamp(-(cu * v.z0) / std::max(std::sqrt(1.0 - cu * cu), 1e-300), v.x0, v.x1);
        const double d = std::sqrt(x * x + v.z0 * v.z0);
        const double h0 = v.y0 / std::sqrt(d * d + v.y0 * v.y0);
        const double h1 = v.y1 / std::sqrt(d * d + v.y1 * v.y1);
        const double h = h0 + static_cast<double>(u.y) * (h1 - h0);
        y = h * h < 1.0 - 1e-12 ? std::clamp(h * d / std::sqrt(1.0 - h * h), v.y0, v.y1) : v.y1;
        pdf = 1.0 / v.solid_angle;
    } else {
        // So small or so far that the sum of angles cancels: sampled as a flat rectangle.
        x = v.x0 + static_cast<double>(u.x) * (v.x1 - v.x0);
        y = v.y0 + static_cast<double>(u.y) * (v.y1 - v.y0);
        const double r2 = x * x + y * y + v.z0 * v.z0;
        pdf = r2 * std::sqrt(r2) / (-v.z0 * 4.0 * half_x_ * half_y_);
    }
    const glm::dvec3 way = x * x_ + y * y_ + v.side * v.z0 * z_;
    const double distance = glm::length(way);
    const auto density = static_cast<float>(pdf);
    if (!(distance > 0.0) || !std::isfinite(density)) return std::nullopt;
    return LightSample{glm::vec3(way / distance), distance, radiance_, density};
}

std::optional<LightHit> RectangleLight::intersect(const trace::Ray& ray) const {
    const double facing = glm::dot(ray.direction, z_);
    if (facing == 0.0) return std::nullopt;
    const double t = glm::dot(center_ - ray.origin, z_) / facing;
    if (!(t > 0.0)) return std::nullopt;
    const glm::dvec3 p = ray.origin + t * ray.direction - center_;
    if (std::abs(glm::dot(p, x_)) > half_x_ || std::abs(glm::dot(p, y_)) > half_y_) return std::nullopt;
    const View v = viewFrom(ray.origin);
    const double pdf =
        v.solid_angle > 1e-7 ? 1.0 / v.solid_angle : t * t / (std::abs(facing) * 4.0 * half_x_ * half_y_);
    return LightHit{t, radiance_, static_cast<float>(pdf)};
}

}  // namespace stratum::shade
