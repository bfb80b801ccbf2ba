#include "shade/integrator/bare_light.h"

#include "base/parallel_for.h"
#include "shade/camera/sampling.h"
#include "shade/environment/normal_bins.h"
#include "shade/integrator/path.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

namespace stratum::shade {
namespace {

constexpr std::size_t kSide = 64;  // nodes of the table
constexpr int kRows = 32;          // rows of cells on the sphere in which light is summed; twice as many columns
constexpr int kFine = 8;           // samples along each side of a cell: fine enough not to miss a small light
constexpr float kGlossPower = 16.0f;
constexpr float kGlintPower = 128.0f;

/// Light from a part of the sphere.
struct LightPart {
    glm::vec3 direction;
    float irradiance;  // luminance, of a surface that faces it
};

glm::vec3 direction(double row, double column) {
    const double theta = std::numbers::pi * row / kRows;
    const double phi = std::numbers::pi * column / kRows;
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

std::vector<LightPart> gather(const SceneDescription& scene, const glm::dvec3& center) {
    constexpr std::size_t kColumns = 2 * std::size_t{kRows};
    std::vector<LightPart> parts(kRows * kColumns);
    parallelFor(kRows, 1, [&](std::size_t first, std::size_t last) {
        std::vector<glm::vec3> directions(std::size_t{kFine} * kFine);
        std::vector<Color> colors(directions.size());
        for (std::size_t row = first; row != last; ++row)
            for (std::size_t column = 0; column < kColumns; ++column) {
                for (std::size_t n = 0; n < directions.size(); ++n) {
                    const std::size_t i = n / kFine;
                    const std::size_t j = n % kFine;
                    directions[n] = direction(static_cast<double>(row) + (static_cast<double>(i) + 0.5) / kFine,
                                              static_cast<double>(column) + (static_cast<double>(j) + 0.5) / kFine);
                }
                scene.environment->radianceStream(directions, colors);
                LightPart& part = parts[row * kColumns + column];
                part.direction = direction(static_cast<double>(row) + 0.5, static_cast<double>(column) + 0.5);
                float sum = 0.0f;
                for (const Color& color : colors) sum += luminance(color);
                const double a = std::numbers::pi * static_cast<double>(row) / kRows;
                const double b = std::numbers::pi * static_cast<double>(row + 1) / kRows;
                const double solid_angle = (std::cos(a) - std::cos(b)) * std::numbers::pi / kRows;
                part.irradiance = sum / static_cast<float>(colors.size()) * static_cast<float>(solid_angle);
            }
    });
    for (const auto& light : scene.lights)
        if (const auto sample = light->sample(center, {0.5f, 0.5f}))
            parts.push_back({sample->direction, luminance(sample->light) / (sample->pdf > 0.0f ? sample->pdf : 1.0f)});
    if (!scene.bed) return parts;
    // The bed in place of what lies below it.
    float above = 0.0f;
    for (const LightPart& part : parts) above += std::max(part.direction.z, 0.0f) * part.irradiance;
    const float bed = luminance(scene.bed->texture.mean()) * above * kInvPi;
    std::erase_if(parts, [](const LightPart& part) { return part.direction.z < 0.0f; });
    for (std::size_t row = kRows / 2; row < kRows; ++row) {
        const double a = std::numbers::pi * static_cast<double>(row) / kRows;
        const double b = std::numbers::pi * static_cast<double>(row + 1) / kRows;
        const double solid_angle = (std::cos(a) - std::cos(b)) * std::numbers::pi / kRows;
        for (std::size_t column = 0; column < kColumns; ++column)
            parts.push_back({direction(static_cast<double>(row) + 0.5, static_cast<double>(column) + 0.5),
                             bed * static_cast<float>(solid_angle)});
    }
    return parts;
}

}  // namespace

BareLight::BareLight(const SceneDescription& scene, const glm::dvec3& center, bool glints)
    : matt_(kSide * kSide), gloss_(matt_.size()), glints_(glints ? matt_.size() : 0) {
    const std::vector<LightPart> parts = gather(scene, center);
    parallelFor(matt_.size(), kSide, [&](std::size_t first, std::size_t last) {
        for (std::size_t n = first; n != last; ++n) {
            const auto place = [](std::size_t i) { return 2.0f * static_cast<float>(i) / (kSide - 1) - 1.0f; };
            const glm::vec3 d = unfolded(place(n % kSide), place(n / kSide));
            float matt = 0.0f;
            float gloss = 0.0f;
            float glint = 0.0f;
            for (const LightPart& part : parts) {
                const float c = std::max(glm::dot(part.direction, d), 0.0f);
                matt += c * part.irradiance;
                float power = c * c;
                power *= power;
                power *= power;
                power *= power;
                gloss += power * part.irradiance;
                if (!glints) continue;
                power *= power;
                power *= power;
                power *= power;
                glint += power * part.irradiance;
            }
            if (glints) glints_[n] = glint * (kGlintPower + 1.0f) * 0.5f * kInvPi;
            matt_[n] = matt * kInvPi;
            gloss_[n] = gloss * (kGlossPower + 1.0f) * 0.5f * kInvPi;
        }
    });
    // Relative to the brightest matt surface, so that the light's unit cancels.
    brightest_ = std::max(0.0f, *std::max_element(matt_.begin(), matt_.end()));
    if (!(brightest_ > 0.0f && std::isfinite(brightest_))) return;
    for (std::vector<float>* table : {&matt_, &gloss_, &glints_})
        for (float& node : *table) node /= brightest_;
}

glm::vec3 BareLight::unfolded(float u, float v) {
    glm::vec3 d(u, v, 1.0f - std::abs(u) - std::abs(v));
    if (d.z < 0.0f) {
        const glm::vec3 e = d;
        d.x = (1.0f - std::abs(e.y)) * std::copysign(1.0f, e.x);
        d.y = (1.0f - std::abs(e.x)) * std::copysign(1.0f, e.y);
    }
    return glm::normalize(d);
}

float BareLight::at(const std::vector<float>& table, const glm::vec3& direction) {
    const auto [u, v] = NormalBins::folded(direction);
    const auto cell = [](float x, std::size_t& i) {
        const float place = std::clamp(0.5f * (x + 1.0f), 0.0f, 1.0f) * (kSide - 1);
        i = std::min(static_cast<std::size_t>(place), kSide - 2);
        return place - static_cast<float>(i);
    };
    std::size_t x = 0;
    std::size_t y = 0;
    const float a = cell(u, x);
    const float b = cell(v, y);
    const float* row = &table[y * kSide + x];
    return (1.0f - b) * ((1.0f - a) * row[0] + a * row[1]) + b * ((1.0f - a) * row[kSide] + a * row[kSide + 1]);
}

// PathIntegrator on the bed: what the print takes from its light. That is all that a transparent picture shows of it,
// see ShadowCatcher, and all that must be sampled in others.

float PathIntegrator::BareBed::share(const glm::dvec3& place) const {
    const double height = print.max.z - place.z;
    if (!(height > 0.0)) return 1.0f;
    const double x = std::max({print.min.x - place.x, place.x - print.max.x, 0.0});
    const double y = std::max({print.min.y - place.y, place.y - print.max.y, 0.0});
    const double cotangent = std::hypot(x, y) / height;  // of the elevation of its top, at least; 0 for endless prints
    return static_cast<float>(1.0 - 0.5 / (1.0 + cotangent * cotangent));
}

void PathIntegrator::addBare(std::span<const SurfacePoint> points, const ShadowRays& shadow_rays,
                             std::span<const Bounce> bounces, std::span<Color> bare) const {
    // What goes down from a bumpy bed meets the bed itself, with or without a print.
    const auto add = [&](std::size_t pixel, const trace::Ray& ray, const Color& light) {
        if (points[pixel].bed && ray.direction.z > 0.0) bare[pixel] += light;
    };
    for (const Bounce& bounce : bounces) {
        const Path& path = *bounce.from->path;
        if (points[path.pixel].bed) bare[path.pixel] += path.throughput * scene_.ambient;
    }
    for (std::size_t k = 0; k < shadow_rays.rays.size(); ++k)
        add(shadow_rays.pixel[k], shadow_rays.rays[k], shadow_rays.light[k]);
    for (const Bounce& bounce : bounces) {
        const Path& path = *bounce.from->path;
        add(path.pixel, bounce.ray, path.throughput * bounce.escaped);
    }
}

void PathIntegrator::reduceBedNoise(std::span<const SurfacePoint> points, std::span<const Color> bare,
                                    std::span<Color> sums) const {
    for (std::size_t n = 0; n < points.size(); ++n)
        if (std::isfinite(points[n].t) && points[n].bed)
            sums[n] += bare_bed_->share(points[n].position) * (points[n].albedo * bare_bed_->radiance - bare[n]);
}

void PathIntegrator::catchShadows(std::span<const SurfacePoint> points, std::span<const Color> sums,
                                  std::span<const Color> bare, std::span<Pixel> pixels) const {
    constexpr int kPlaces = 4;  // on a side of a light: its irradiance is a scale, not a shadow
    for (std::size_t n = 0; n < points.size(); ++n) {
        const SurfacePoint& point = points[n];
        if (!std::isfinite(point.t)) {
            pixels[n] = {};
        } else if (!point.bed) {
            pixels[n] = {sums[n], 1.0f};
        } else {
            Color irradiance = scene_.catcher->irradiance;
            for (const auto& light : scene_.lights) irradiance += irradianceFrom(*light, point.position, kPlaces);
            const float all = luminance(point.albedo * irradiance) * kInvPi;
            pixels[n] = {Color(0.0f), all > 0.0f ? luminance(bare[n] - sums[n]) / all : 0.0f};
        }
    }
}

}  // namespace stratum::shade
