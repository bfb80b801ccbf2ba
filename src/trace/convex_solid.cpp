#include "trace/convex_solid.h"

#include "base/error.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

namespace stratum::trace {
namespace {

/// The part of a ray that is inside of something, and the normals where it begins and ends.
struct Inside {
    double begin = -kInfinity, end = kInfinity;
    glm::dvec3 begin_normal{0.0}, end_normal{0.0};

    bool empty() const { return !(begin <= end); }
    void beginAt(double t, const glm::dvec3& normal) {
        if (t > begin) {
            begin = t;
            begin_normal = normal;
        }
    }
    void endAt(double t, const glm::dvec3& normal) {
        if (t < end) {
            end = t;
            end_normal = normal;
        }
    }
};

constexpr Inside kNothing{kInfinity, -kInfinity, {}, {}};

Inside inSlab(const Slab& slab, const Ray& ray) {
    const double at = glm::dot(slab.normal, ray.origin);
    const double speed = glm::dot(slab.normal, ray.direction);
    if (speed == 0.0) return at >= slab.low && at <= slab.high ? Inside{} : kNothing;
    const double sign = speed > 0.0 ? 1.0 : -1.0;
    const double to_low = (slab.low - at) / speed;
    const double to_high = (slab.high - at) / speed;
    return {std::min(to_low, to_high), std::max(to_low, to_high), -sign * slab.normal, sign * slab.normal};
}

void cut(Inside& inside, const Inside& other) {
    inside.beginAt(other.begin, other.begin_normal);
    inside.endAt(other.end, other.end_normal);
}

/// inside(ray) gives the part of a ray that is in the solid.
template <typename Solid>
class SolidTracer final : public Tracer {
public:
    explicit SolidTracer(const Solid& solid) : solid_(solid) {}
    bool intersect(const Ray& ray, Hit& hit) override {
        const Inside inside = solid_.inside(ray);
        if (inside.empty()) return false;
        const bool enters = inside.begin >= ray.t_min;
        const double t = enters ? inside.begin : inside.end;
        if (!(t >= ray.t_min && t <= ray.t_max)) return false;
        hit.t = t;
        hit.position = ray.origin + t * ray.direction;
        hit.normal = enters ? inside.begin_normal : inside.end_normal;
        return true;
    }
    bool occluded(const Ray& ray) override {
        const Inside inside = solid_.inside(ray);
        if (inside.empty()) return false;
        const double t = inside.begin >= ray.t_min ? inside.begin : inside.end;
        return t >= ray.t_min && t <= ray.t_max;
    }

private:
    const Solid& solid_;
};

template <typename Solid>
class SolidIntersector final : public Intersector {
public:
    SolidIntersector(Solid solid, const Box& bounds) : solid_(std::move(solid)), bounds_(bounds) {}
    std::unique_ptr<Tracer> makeTracer() const override { return std::make_unique<SolidTracer<Solid>>(solid_); }
    std::string_view name() const override { return "solid"; }
    Box bounds() const override { return bounds_; }
    double voxelSize() const override { return glm::length(bounds_.max - bounds_.min); }
    std::size_t bytes() const override { return 0; }
    // Far above the rounding of hits, far below what can be seen.
    double surfaceOffset() const override {
        return 1e-9 * glm::length(glm::max(glm::abs(bounds_.min), glm::abs(bounds_.max)));
    }

private:
    Solid solid_;
    Box bounds_;
};

struct Slabs {
    std::vector<Slab> slabs;

    Inside inside(const Ray& ray) const {
        Inside result;
        for (const Slab& slab : slabs) cut(result, inSlab(slab, ray));
        return result;
    }
};

struct Cone {
    Slab ends;
    double low_radius, slope;  // radius = low_radius + slope (z - ends.low)

    Inside inside(const Ray& ray) const {
        Inside result = inSlab(ends, ray);
        if (!result.empty()) cut(result, inSide(ray));
        return result;
    }

private:
    double radiusAt(double z) const { return low_radius + slope * (z - ends.low); }

    glm::dvec3 normalAt(const Ray& ray, double t) const {
        const glm::dvec3 p = ray.origin + t * ray.direction;
        const double radius = std::hypot(p.x, p.y);
        return glm::normalize(glm::dvec3(p.x, p.y, -slope * radius));
    }

    // x^2 + y^2 <= radius^2 along the ray is a t^2 + 2 b t + c <= 0. Between the ends the radius is above 0, so what
    // lies beyond the cone's apex is cut off.
    Inside inSide(const Ray& ray) const {
        const glm::dvec3& o = ray.origin;
        const glm::dvec3& d = ray.direction;
        const double growth = slope * d.z;
        const double radius = radiusAt(o.z);
        const double a = d.x * d.x + d.y * d.y - growth * growth;
        const double b = o.x * d.x + o.y * d.y - growth * radius;
        const double c = o.x * o.x + o.y * o.y - radius * radius;
        const double root = b * b - a * c;
        if (root <= 0.0) return a <= 0.0 && c <= 0.0 ? Inside{} : kNothing;
        if (a == 0.0) {
            // Parallel to a line of the cone: it is crossed once.
            const double t = c / (-2.0 * b);
            return b > 0.0 ? Inside{-kInfinity, t, {}, normalAt(ray, t)} : Inside{t, kInfinity, normalAt(ray, t), {}};
        }
        const double q = -(b + std::copysign(std::sqrt(root), b));
        const auto [first, second] = std::minmax({q / a, c / q});
        if (a > 0.0) return {first, second, normalAt(ray, first), normalAt(ray, second)};
        // Steeper than the cone: of its two halves the one is meant into which the radius grows.
        if (growth > 0.0) return {second, kInfinity, normalAt(ray, second), {}};
        return {-kInfinity, first, {}, normalAt(ray, first)};
    }
};

}  // namespace

std::unique_ptr<Intersector> makeSlabSolid(std::vector<Slab> slabs, const Box& bounds) {
    for (const Slab& slab : slabs)
        if (!(std::abs(glm::length(slab.normal) - 1.0) < 1e-9 && slab.low < slab.high))
            throw UsageError(
                fmt::format("a slab from {:g} to {:g}: needs a unit normal and a thickness", slab.low, slab.high));
    return std::make_unique<SolidIntersector<Slabs>>(Slabs{std::move(slabs)}, bounds);
}

std::unique_ptr<Intersector> makeBoxSolid(const glm::dvec3& min, const glm::dvec3& max) {
    return makeSlabSolid({{{1, 0, 0}, min.x, max.x}, {{0, 1, 0}, min.y, max.y}, {{0, 0, 1}, min.z, max.z}}, {min, max});
}

std::unique_ptr<Intersector> makeHexagonSolid(double across_flats, double low, double high) {
    const double half = 0.5 * across_flats;
    std::vector<Slab> slabs{{{0, 0, 1}, low, high}};
    for (int side = 0; side < 3; ++side) {
        const double angle = side * std::numbers::pi / 3;
        slabs.push_back({{std::cos(angle), std::sin(angle), 0}, -half, half});
    }
    const double corner = half / std::cos(std::numbers::pi / 6);
    return makeSlabSolid(std::move(slabs), {{-half, -corner, low}, {half, corner, high}});
}

std::unique_ptr<Intersector> makeConeSolid(double low, double low_radius, double high, double high_radius) {
    if (!(low < high && low_radius > 0.0 && high_radius > 0.0))
        throw UsageError(
            fmt::format("a cone from z {:g}, radius {:g}, to z {:g}, radius {:g}: needs a height, and radii "
                        "above 0",
                        low, low_radius, high, high_radius));
    const double most = std::max(low_radius, high_radius);
    return std::make_unique<SolidIntersector<Cone>>(
        Cone{{{0, 0, 1}, low, high}, low_radius, (high_radius - low_radius) / (high - low)},
        Box{{-most, -most, low}, {most, most, high}});
}

}  // namespace stratum::trace
