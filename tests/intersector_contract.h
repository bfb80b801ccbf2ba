// What every trace::Intersector promises (trace/intersector.h), as one test for all of them.
#pragma once

#include "trace/intersector.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace stratum::test {

/// A closed solid whose surface is known.
struct ContractCase {
    std::string name;
    std::shared_ptr<const trace::Intersector> shape;
    std::function<double(const glm::dvec3&)> distance;  ///< signed, negative inside; exact near the surface or a bound
    double tolerance = 1e-6;                            ///< of the surface, world units
    double misses = 0;  ///< share of the rays that an approximate method may answer wrongly, 0..1
};

inline void PrintTo(const ContractCase& c, std::ostream* out) { *out << c.name; }

/// Rays from anywhere in a box twice as large as the shape, also from inside of it.
inline std::vector<trace::Ray> raysAnywhere(const trace::Box& box, std::size_t count) {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> place(-0.25, 1.25);
    std::vector<trace::Ray> rays(count);
    for (trace::Ray& ray : rays) {
        for (int axis = 0; axis < 3; ++axis)
            ray.origin[axis] = box.min[axis] + place(random) * (box.max[axis] - box.min[axis]);
        ray.direction = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    }
    return rays;
}

/// One ray; returns what is wrong, or nothing.
inline std::string brokenPromise(const ContractCase& c, trace::Tracer& tracer, const trace::Ray& ray) {
    const double start = c.distance(ray.origin);
    if (std::abs(start) < 2 * c.tolerance) return {};
    trace::Hit hit;
    const bool found = tracer.intersect(ray, hit);
    if (tracer.occluded(ray) != found) return "any hit differs from nearest hit";
    if (!found) return start < 0 ? "a ray that starts inside meets nothing" : std::string();
    const double cosine = glm::dot(hit.normal, ray.direction);
    // Where rays graze, two hits lie within the tolerance of each other.
    if (std::abs(cosine) < 0.05) return {};
    if ((start < 0) != (cosine > 0)) return start < 0 ? "enters what it is inside of" : "leaves what it is outside of";
    if (std::abs(c.distance(hit.position)) > c.tolerance) return "the hit is not on the surface";
    if (glm::length(ray.origin + hit.t * ray.direction - hit.position) > 1e-6) return "position is not at t";

    const double margin = 4 * c.tolerance / std::abs(cosine);
    trace::Ray part = ray;
    part.t_max = hit.t - margin;
    trace::Hit none;
    if (part.t_max > 0 && (tracer.intersect(part, none) || tracer.occluded(part))) return "a hit beyond t_max";
    part.t_max = hit.t + margin;
    trace::Hit same;
    if (!tracer.intersect(part, same) || std::abs(same.t - hit.t) > margin) return "another hit with t_max behind it";
    if (!tracer.occluded(part)) return "no hit before t_max";

    part.t_max = trace::kInfinity;
    part.t_min = hit.t + margin;
    trace::Hit next;
    const bool more = tracer.intersect(part, next);
    if (tracer.occluded(part) != more) return "from t_min, any hit differs from nearest hit";
    if (more && next.t < part.t_min) return "a hit before t_min";
    const double behind = c.distance(ray.origin + part.t_min * ray.direction);
    if (std::abs(behind) < c.tolerance) return {};
    if (behind < 0 && !more) return "a ray with t_min inside meets nothing";
    if (more && std::abs(glm::dot(next.normal, ray.direction)) > 0.05 &&
        (behind < 0) != (glm::dot(next.normal, ray.direction) > 0))
        return "from t_min, met from the wrong side";
    return {};
}

inline void expectContract(const ContractCase& c) {
    const std::unique_ptr<trace::Tracer> tracer = c.shape->makeTracer();
    const std::vector<trace::Ray> rays = raysAnywhere(c.shape->bounds(), 2000);
    std::size_t wrong = 0, inside = 0;
    std::string first;
    for (std::size_t n = 0; n < rays.size(); ++n) {
        inside += c.distance(rays[n].origin) < 0 ? 1 : 0;
        const std::string broken = brokenPromise(c, *tracer, rays[n]);
        if (broken.empty()) continue;
        if (wrong++ == 0) first = broken + ", ray " + std::to_string(n);
    }
    EXPECT_LE(static_cast<double>(wrong), c.misses * static_cast<double>(rays.size())) << first;
    EXPECT_GT(inside, 30U);

    // Streams, some of bounded rays.
    std::vector<trace::Ray> bounded = rays;
    for (std::size_t n = 0; n < bounded.size(); n += 3) bounded[n].t_max = 1.0;
    for (std::size_t n = 1; n < bounded.size(); n += 3) bounded[n].t_min = 0.5;
    std::vector<trace::Hit> hits(bounded.size());
    std::vector<std::uint8_t> blocked(bounded.size());
    tracer->intersectStream(bounded, hits);
    tracer->occludedStream(bounded, blocked);
    for (std::size_t n = 0; n < bounded.size(); ++n) {
        trace::Hit hit;
        const bool found = tracer->intersect(bounded[n], hit);
        ASSERT_EQ(std::isfinite(hits[n].t), found) << n;
        ASSERT_EQ(blocked[n] != 0, tracer->occluded(bounded[n])) << n;
        if (!found) continue;
        ASSERT_EQ(hits[n].t, hit.t) << n;
        ASSERT_EQ(hits[n].normal, hit.normal) << n;
    }
}

}  // namespace stratum::test
