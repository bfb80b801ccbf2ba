// Intersectors with an answer on paper, to test light without a level set.
#pragma once

#include "trace/intersector.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string_view>

namespace stratum::test {

/// An Intersector whose rays are answered by a function. The function must be safe to call from many threads.
class FunctionIntersector : public trace::Intersector {
public:
    using Nearest = std::function<bool(const trace::Ray&, trace::Hit&)>;
    FunctionIntersector(trace::Box box, double offset, Nearest nearest)
        : box_(box), offset_(offset), nearest_(std::move(nearest)) {}

    std::unique_ptr<trace::Tracer> makeTracer() const override { return std::make_unique<Rays>(nearest_); }
    std::string_view name() const override { return "function"; }
    trace::Box bounds() const override { return box_; }
    double voxelSize() const override { return 0.1; }
    std::size_t bytes() const override { return 0; }
    double surfaceOffset() const override { return offset_; }

private:
    struct Rays final : trace::Tracer {
        explicit Rays(const Nearest& f) : nearest(f) {}
        bool intersect(const trace::Ray& ray, trace::Hit& hit) override { return nearest(ray, hit); }
        bool occluded(const trace::Ray& ray) override {
            trace::Hit hit;
            return nearest(ray, hit);
        }
        const Nearest& nearest;
    };
    trace::Box box_;
    double offset_;
    Nearest nearest_;
};

/// Nothing at all, in a box of this size about the origin.
inline FunctionIntersector nothing(double half = 1.0) {
    return {{glm::dvec3(-half), glm::dvec3(half)}, 1e-6, [](const trace::Ray&, trace::Hit&) { return false; }};
}

inline FunctionIntersector sphere(const glm::dvec3& center, double radius) {
    return {{center - radius, center + radius}, 1e-6 * radius, [=](const trace::Ray& ray, trace::Hit& hit) {
                const glm::dvec3 m = ray.origin - center;
                const double b = glm::dot(m, ray.direction);
                const double root = b * b - glm::dot(m, m) + radius * radius;
                if (root < 0.0) return false;
                for (const double t : {-b - std::sqrt(root), -b + std::sqrt(root)}) {
                    if (t < ray.t_min || t > ray.t_max) continue;
                    hit.t = t;
                    hit.position = ray.origin + t * ray.direction;
                    hit.normal = glm::normalize(hit.position - center);
                    return true;
                }
                return false;
            }};
}

/// A printed vase: a stack of beads of a lobed, twisting outline on a closed floor, found by sphere tracing.
class Vase {
public:
    double layer_height = 0.3;  // mm, like all of it
    double bead_width = 0.7;
    int layers = 140;

    double outline(double angle, int layer) const {
        const double s = static_cast<double>(layer) / layers;
        const double profile = 13.0 + 4.5 * std::sin(4.6 * s + 0.4) + 2.0 * s;
        return profile * (1.0 + 0.055 * std::cos(6.0 * angle + 2.2 * s));
    }
    double distance(const glm::dvec3& p) const {
        const double r = std::hypot(p.x, p.y);
        const double angle = std::atan2(p.y, p.x);
        const int near = static_cast<int>(std::floor(p.z / layer_height));
        double nearest = 1e9;
        for (int k = near - 1; k <= near + 1; ++k) {
            const int layer = std::clamp(k, 0, layers - 1);
            const double radius = outline(angle, layer);
            const double rho = layer < 4 ? r - radius : std::abs(r - radius);
            const double flat = std::max(rho - 0.5 * (bead_width - layer_height), 0.0);
            nearest = std::min(nearest, std::hypot(flat, p.z - (layer + 0.5) * layer_height) - 0.5 * layer_height);
        }
        return nearest;
    }
    trace::Box box() const { return {{-23.0, -23.0, -0.3}, {23.0, 23.0, layers * layer_height + 0.3}}; }

    bool nearest(const trace::Ray& ray, trace::Hit& hit) const {
        const trace::Box b = box();
        double t = ray.t_min;
        double end = ray.t_max;
        for (int i = 0; i < 3; ++i) {
            const double d = ray.direction[i];
            if (d == 0.0) {
                if (ray.origin[i] < b.min[i] || ray.origin[i] > b.max[i]) return false;
                continue;
            }
            const double t0 = (b.min[i] - ray.origin[i]) / d;
            const double t1 = (b.max[i] - ray.origin[i]) / d;
            t = std::max(t, std::min(t0, t1));
            end = std::min(end, std::max(t0, t1));
        }
        for (int step = 0; step < 2000 && t <= end; ++step) {
            const glm::dvec3 p = ray.origin + t * ray.direction;
            const double d = distance(p);
            if (d < 1e-4) {
                hit = {t, p, normal(p)};
                return true;
            }
            t += 0.75 * d;
        }
        return false;
    }
    glm::dvec3 normal(const glm::dvec3& p) const {
        constexpr double h = 1e-4;
        return glm::normalize(glm::dvec3(distance(p + glm::dvec3(h, 0, 0)) - distance(p - glm::dvec3(h, 0, 0)),
                                         distance(p + glm::dvec3(0, h, 0)) - distance(p - glm::dvec3(0, h, 0)),
                                         distance(p + glm::dvec3(0, 0, h)) - distance(p - glm::dvec3(0, 0, h))));
    }
    FunctionIntersector intersector() const {
        return {box(), 1e-3, [vase = *this](const trace::Ray& ray, trace::Hit& hit) { return vase.nearest(ray, hit); }};
    }
};

}  // namespace stratum::test
