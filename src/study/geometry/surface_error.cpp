#include "study/geometry/surface_error.h"
#include "base/parallel_for.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

namespace stratum::study {
namespace {

constexpr std::size_t kDirections = 24;

// Points of a spiral from pole to pole: evenly spread.
std::array<glm::dvec3, kDirections> spreadDirections() {
    std::array<glm::dvec3, kDirections> all;
    const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
    for (std::size_t n = 0; n < kDirections; ++n) {
        const double z = 1 - 2 * (static_cast<double>(n) + 0.5) / kDirections;
        const double r = std::sqrt(1 - z * z);
        const double turn = golden * static_cast<double>(n);
        all[n] = {r * std::cos(turn), r * std::sin(turn), z};
    }
    return all;
}

// The zero nearest to a point, as far as rays find it.
class NearestZero {
public:
    NearestZero(trace::Tracer& tracer, const glm::dvec3& p, double search)
        : tracer_(tracer), p_(p), best_(search), skin_(1e-6 * search) {}

    // Along a line through the point, this way; it begins a skin before the point, so that a zero at the point itself
    // is not lost to rounding.
    void look(const glm::dvec3& direction) { from(p_ - skin_ * direction, direction, best_ + skin_); }

    // Towards the foot point: from the point's shadow on the tangent plane of what was found.
    void refine() {
        if (!found_) return;
        const glm::dvec3 normal = hit_.normal;
        const glm::dvec3 shadow = p_ - glm::dot(p_ - hit_.position, normal) * normal;
        const double reach = best_;
        from(shadow + reach * normal, -normal, 2 * reach);
        from(shadow - reach * normal, normal, 2 * reach);
    }

    bool found() const { return found_; }
    double distance() const { return best_; }
    const trace::Hit& hit() const { return hit_; }

private:
    void from(const glm::dvec3& origin, const glm::dvec3& direction, double reach) {
        trace::Hit hit;
        if (!tracer_.intersect({origin, direction, 0, reach}, hit)) return;
        const double distance = glm::length(hit.position - p_);
        if (distance >= best_) return;
        best_ = distance;
        hit_ = hit;
        found_ = true;
    }

    trace::Tracer& tracer_;
    glm::dvec3 p_;
    double best_, skin_;
    trace::Hit hit_;
    bool found_ = false;
};

}  // namespace

Spread spreadOf(std::vector<double> values) {
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    Spread spread;
    const auto count = static_cast<double>(values.size());
    for (const double v : values) {
        spread.mean += v / count;
        spread.rms += v * v / count;
    }
    spread.rms = std::sqrt(spread.rms);
    spread.p999 = values[std::min(values.size() - 1, values.size() * 999 / 1000)];
    spread.max = values.back();
    return spread;
}

SurfaceError surfaceError(const trace::Intersector& level_set, std::span<const ExactSolid::SurfacePoint> points,
                          double search) {
    static const auto kSpread = spreadDirections();
    std::vector<double> distances(points.size(), -1);
    std::vector<double> angles(points.size(), -1);
    parallelFor(points.size(), 256, [&](std::size_t first, std::size_t last) {
        const auto tracer = level_set.makeTracer();
        for (std::size_t n = first; n != last; ++n) {
            const auto& [position, normal] = points[n];
            NearestZero zero(*tracer, position, search);
            zero.look(-normal);
            zero.look(normal);
            for (const glm::dvec3& direction : kSpread) zero.look(direction);
            for (int step = 0; step < 3; ++step) zero.refine();
            if (!zero.found()) continue;
            distances[n] = zero.distance();
            const double cosine = std::clamp(glm::dot(zero.hit().normal, normal), -1.0, 1.0);
            angles[n] = std::acos(cosine) * 180 / std::numbers::pi;
        }
    });
    std::erase_if(distances, [](double d) { return d < 0; });
    std::erase_if(angles, [](double a) { return a < 0; });
    SurfaceError error;
    error.lost_share = 1 - static_cast<double>(distances.size()) / static_cast<double>(points.size());
    error.distance = spreadOf(std::move(distances));
    error.angle = spreadOf(std::move(angles));
    return error;
}

Spread backwardError(const trace::Intersector& level_set, const ExactSolid& exact, std::size_t rays) {
    const trace::Box box = level_set.bounds();
    const double radius = 0.5 * glm::length(box.max - box.min);
    std::vector<double> errors(rays, -1);
    parallelFor(rays, 256, [&](std::size_t first, std::size_t last) {
        const auto tracer = level_set.makeTracer();
        for (std::size_t n = first; n != last; ++n) {
            std::mt19937_64 random(n);
            std::uniform_real_distribution<double> unit(0, 1);
            std::normal_distribution<double> normal;
            const glm::dvec3 from = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
            const glm::dvec3 target =
                box.min + (box.max - box.min) * glm::dvec3(unit(random), unit(random), unit(random));
            trace::Hit hit;
            if (!tracer->intersect({target + from * (2 * radius), -from}, hit)) continue;
            errors[n] = std::abs(exact.distance(hit.position));
        }
    });
    std::erase_if(errors, [](double e) { return e < 0; });
    return spreadOf(std::move(errors));
}

}  // namespace stratum::study
