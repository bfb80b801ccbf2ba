#include "shade/light/light.h"

#include "base/error.h"
#include "base/names.h"
#include "shade/brdf/preset.h"
#include "shade/camera/sampling.h"
#include "shade/frame.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::shade {
namespace {

constexpr std::string_view kLightOption = "--light";

glm::dvec3 vectorAt(const Preset& preset, std::size_t first) {
    return {preset.values[first], preset.values[first + 1], preset.values[first + 2]};
}

Color colorAt(const Preset& preset, std::size_t first, std::string_view what) {
    for (std::size_t i = first; i < first + 3; ++i) requireRange(preset, i, 0.0f, 1e9f, kLightOption, what);
    return Color(vectorAt(preset, first));
}

glm::vec3 towards(const Preset& preset, std::string_view text) {
    const glm::dvec3 travel = vectorAt(preset, 0);
    if (!(glm::length(travel) > 0.0))
        throw UsageError(
            fmt::format("{} {}: the direction is zero; write e.g. {}:1,1,-2,3,3,3", kLightOption, text, preset.name));
    return glm::vec3(-glm::normalize(travel));
}

}  // namespace

std::shared_ptr<const Light> parseLight(std::string_view text) {
    Preset preset = parsePreset(text, kLightOption);
    if (preset.name == "directional") {
        requireValues(preset, 6, kLightOption, "directional:X,Y,Z,R,G,B");
        return std::make_shared<DirectionalLight>(towards(preset, text), colorAt(preset, 3, "an irradiance"));
    }
    if (preset.name == "sun") {
        if (preset.values.size() == 6) preset.values.push_back(SunLight::kRealDiameter);
        requireValues(preset, 7, kLightOption, "sun:X,Y,Z,R,G,B,DEGREES");
        requireRange(preset, 6, 0.01f, 90.0f, kLightOption, "its diameter in degrees");
        return std::make_shared<SunLight>(towards(preset, text), colorAt(preset, 3, "an irradiance"), preset.values[6]);
    }
    if (preset.name == "point") {
        requireValues(preset, 6, kLightOption, "point:X,Y,Z,R,G,B");
        return std::make_shared<PointLight>(vectorAt(preset, 0), colorAt(preset, 3, "an intensity"));
    }
    if (preset.name == "rectangle") {
        requireValues(preset, 12, kLightOption, "rectangle:X,Y,Z,UX,UY,UZ,VX,VY,VZ,R,G,B");
        const glm::dvec3 u = vectorAt(preset, 3);
        const glm::dvec3 v = vectorAt(preset, 6);
        if (!(glm::length(u) > 0.0 && glm::length(v) > 0.0) ||
            std::abs(glm::dot(u, v)) > 1e-4 * glm::length(u) * glm::length(v))
            throw UsageError(
                fmt::format("{} {}: the half edges U and V must be perpendicular and not zero", kLightOption, text));
        return std::make_shared<RectangleLight>(vectorAt(preset, 0), u, v, colorAt(preset, 9, "a radiance"));
    }
    throw UsageError(fmt::format(
        "{} {}: unknown light; write directional:, sun:, point:, rectangle: or ambient: and "
        "numbers, see -h{}",
        kLightOption, text, didYouMean(preset.name, {"directional", "sun", "point", "rectangle", "ambient"})));
}

std::optional<Color> parseAmbient(std::string_view text) {
    if (text.substr(0, text.find(':')) != "ambient") return std::nullopt;
    const Preset preset = parsePreset(text, kLightOption);
    requireValues(preset, 3, kLightOption, "ambient:R,G,B");
    return colorAt(preset, 0, "a radiance");
}

Color irradianceFrom(const Light& light, const glm::dvec3& point, int side) {
    if (!light.hasExtent()) side = 1;
    glm::dvec3 sum(0.0);
    for (int i = 0; i < side; ++i) {
        for (int j = 0; j < side; ++j) {
            const auto s = light.sample(point, {(static_cast<float>(i) + 0.5f) / static_cast<float>(side),
                                                (static_cast<float>(j) + 0.5f) / static_cast<float>(side)});
            if (s && s->direction.z > 0.0f)
                sum += glm::dvec3(s->light * (s->direction.z / (s->pdf > 0.0f ? s->pdf : 1.0f)));
        }
    }
    return Color(sum / static_cast<double>(side * side));
}

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

std::optional<LightSample> PointLight::sample(const glm::dvec3& point, const glm::vec2&) const {
    const glm::dvec3 way = position_ - point;
    const double distance = glm::length(way);
    if (!(distance > 0.0)) return std::nullopt;
    const Color light = intensity_ * static_cast<float>(1.0 / (distance * distance));
    if (!isFinite(light)) return std::nullopt;
    return LightSample{glm::vec3(way / distance), distance, light, 0.0f};
}

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
