#include "trace/sdf_intersector.h"

#include "base/error.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace stratum::trace {
namespace {

constexpr int kMostSteps = 100000;
constexpr double kFar = 1e5;  // world units, from where the ray meets the bounds

class SdfTracer final : public Tracer {
public:
    SdfTracer(const Sdf& shape, const Box& bounds, double tolerance)
        : shape_(shape), bounds_(bounds), tolerance_(tolerance) {}

    bool intersect(const Ray& ray, Hit& hit) override {
        double low = 0;
        double high = 0;
        if (!march(ray, low, high)) return false;
        const bool inside = isInside(ray, low);
        // Until the two are adjacent doubles: at most some 60 times.
        for (double middle = 0.5 * (low + high); middle > low && middle < high; middle = 0.5 * (low + high))
            (isInside(ray, middle) == inside ? low : high) = middle;
        hit.t = high;
        hit.position = ray.origin + high * ray.direction;
        hit.normal = normalAt(hit.position, ray.direction);
        return true;
    }
    bool occluded(const Ray& ray) override {
        double low = 0;
        double high = 0;
        return march(ray, low, high);
    }

private:
    double at(const Ray& ray, double t) const { return shape_.distance(ray.origin + t * ray.direction); }
    bool isInside(const Ray& ray, double t) const { return at(ray, t) < 0; }

    /// Two positions on the ray with the first change of sign between them; false if there is none.
    bool march(const Ray& ray, double& low, double& high) const {
        double t = ray.t_min;
        double end = ray.t_max;
        for (int axis = 0; axis < 3; ++axis) {
            const double inverse = 1 / ray.direction[axis];
            if (!std::isfinite(inverse)) {
                if (!(ray.origin[axis] >= bounds_.min[axis] && ray.origin[axis] <= bounds_.max[axis])) return false;
                continue;
            }
            const double a = (bounds_.min[axis] - ray.origin[axis]) * inverse;
            const double b = (bounds_.max[axis] - ray.origin[axis]) * inverse;
            if (std::isnan(a) || std::isnan(b)) return false;
            t = std::max(t, std::min(a, b));
            end = std::min(end, std::max(a, b));
        }
        // One step beyond the bounds, so that a surface on them is crossed.
        end = std::min({end + tolerance_, ray.t_max, t + kFar});
        if (!(t <= end)) return false;
        // Likewise one step before them.
        t = std::max(ray.t_min, t - tolerance_);
        const bool inside = isInside(ray, t);
        for (int step = 0; step < kMostSteps && t < end; ++step) {
            const double next = std::min(t + std::max(std::abs(at(ray, t)), tolerance_), end);
            if (!(next > t)) return false;  // far from the origin a step can be lost in rounding
            if (isInside(ray, next) != inside) {
                low = t;
                high = next;
                return true;
            }
            t = next;
        }
        return false;
    }

    glm::dvec3 normalAt(const glm::dvec3& p, const glm::dvec3& direction) const {
        // Short compared with the shapes, long compared with rounding errors of the position.
        const double h = std::max(0.1 * tolerance_, 1e-7 * std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}));
        glm::dvec3 gradient;
        for (int axis = 0; axis < 3; ++axis) {
            glm::dvec3 step(0.0);
            step[axis] = h;
            gradient[axis] = shape_.distance(p + step) - shape_.distance(p - step);
        }
        const double length = glm::length(gradient);
        return length > 0 ? gradient / length : -direction;
    }

    const Sdf& shape_;
    const Box bounds_;
    const double tolerance_;
};

class SdfIntersector final : public Intersector {
public:
    SdfIntersector(SdfPtr shape, double tolerance)
        : shape_(std::move(shape)), bounds_(shape_->bounds()), tolerance_(tolerance) {}

    std::unique_ptr<Tracer> makeTracer() const override {
        return std::make_unique<SdfTracer>(*shape_, bounds_, tolerance_);
    }
    std::string_view name() const override { return "sdf"; }
    Box bounds() const override { return bounds_; }
    double voxelSize() const override { return tolerance_; }
    std::size_t bytes() const override { return 0; }
    // Hits are on the surface except for rounding: a tenth of the tolerance is enough, also for the normal's
    // differences.
    double surfaceOffset() const override {
        double farthest = 0;
        for (int axis = 0; axis < 3; ++axis)
            for (const double side : {bounds_.min[axis], bounds_.max[axis]})
                if (std::isfinite(side)) farthest = std::max(farthest, std::abs(side));
        return std::max(0.1 * tolerance_, 16 * std::numeric_limits<double>::epsilon() * farthest);
    }

private:
    SdfPtr shape_;
    Box bounds_;
    double tolerance_;
};

}  // namespace

std::unique_ptr<Intersector> makeSdfIntersector(SdfPtr shape, double tolerance) {
    if (!(tolerance > 0 && std::isfinite(tolerance)))
        throw UsageError(fmt::format("the tolerance of a shape is {}; it must be a finite number above 0", tolerance));
    return std::make_unique<SdfIntersector>(std::move(shape), tolerance);
}

}  // namespace stratum::trace
