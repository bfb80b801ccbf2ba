#include "march_rays.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

namespace stratum::bench {
namespace {

using trace::Hit;
using trace::Ray;

constexpr int kTile = 32;
constexpr int kBlock = 4;     // pixels; packets of 16 rays are most alike in squares
constexpr double kShort = 5;  // mm

std::vector<Ray> primaryRays(const trace::Box& box, int side) {
    const glm::dvec3 center = 0.5 * (box.min + box.max);
    const double radius = 0.5 * glm::length(box.max - box.min);
    const glm::dvec3 forward = glm::normalize(glm::dvec3(0.6, 0.75, -0.45));
    const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0, 0, 1)));
    const glm::dvec3 up = glm::cross(right, forward);
    constexpr double kDistance = 4;  // of the eye, in radii
    const glm::dvec3 eye = center - kDistance * radius * forward;
    double half = 0;  // tangent: the box just fits
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 p =
            glm::dvec3((corner & 4) != 0 ? box.max.x : box.min.x, (corner & 2) != 0 ? box.max.y : box.min.y,
                       (corner & 1) != 0 ? box.max.z : box.min.z) -
            eye;
        const double depth = glm::dot(p, forward);
        half = std::max({half, std::abs(glm::dot(p, right)) / depth, std::abs(glm::dot(p, up)) / depth});
    }
    half *= 0.85;  // parts don't reach the corners of their boxes
    std::vector<Ray> rays;
    for (int ty = 0; ty < side; ty += kTile)
        for (int tx = 0; tx < side; tx += kTile)
            for (int n = 0; n < kTile * kTile; ++n) {
                const int block = n / (kBlock * kBlock);
                const int in_block = n % (kBlock * kBlock);
                const int x = tx + block % (kTile / kBlock) * kBlock + in_block % kBlock;
                const int y = ty + block / (kTile / kBlock) * kBlock + in_block / kBlock;
                const double u = half * (2 * (x + 0.5) / side - 1);
                const double v = half * (1 - 2 * (y + 0.5) / side);
                rays.push_back({eye, glm::normalize(forward + u * right + v * up)});
            }
    return rays;
}

glm::dvec3 cosineDirection(const glm::dvec3& n, std::mt19937& random) {
    std::uniform_real_distribution<double> uniform(0, 1);
    const double r = std::sqrt(uniform(random));
    const double a = 2 * std::numbers::pi * uniform(random);
    const glm::dvec3 side = std::abs(n.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
    const glm::dvec3 u = glm::normalize(glm::cross(n, side));
    const glm::dvec3 v = glm::cross(n, u);
    return glm::normalize(r * std::cos(a) * u + r * std::sin(a) * v + std::sqrt(1 - r * r) * n);
}

}  // namespace

std::vector<RaySet> makeRaySets(const trace::Intersector& exact, int side, double offset) {
    std::vector<RaySet> sets;
    sets.push_back({"primary", primaryRays(exact.bounds(), side)});
    std::vector<std::pair<Ray, Hit>> seen;
    const auto tracer = exact.makeTracer();
    for (const Ray& ray : sets[0].rays) {
        Hit hit;
        if (tracer->intersect(ray, hit)) seen.emplace_back(ray, hit);
    }
    std::mt19937 random(1);
    const auto cosine = [&](const char* name, std::size_t step, int count, double t_max) {
        RaySet set{name, {}, true};
        for (std::size_t n = 0; n < seen.size(); n += step)
            for (int k = 0; k < count; ++k) {
                const auto& [ray, hit] = seen[n];
                const glm::dvec3 normal = glm::dot(hit.normal, ray.direction) > 0 ? -hit.normal : hit.normal;
                set.rays.push_back({hit.position + offset * normal, cosineDirection(normal, random), 0, t_max});
            }
        sets.push_back(std::move(set));
    };
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    cosine("AO, 1 a hit", 1, 1, kInfinity);
    cosine("AO, 8 a hit", 4, 8, kInfinity);
    cosine("AO, 5 mm", 1, 1, kShort);
    RaySet mirror{"mirror", {}};
    for (const auto& [ray, hit] : seen) {
        const glm::dvec3 normal = glm::dot(hit.normal, ray.direction) > 0 ? -hit.normal : hit.normal;
        mirror.rays.push_back({hit.position + offset * normal, glm::normalize(glm::reflect(ray.direction, normal))});
    }
    sets.push_back(std::move(mirror));
    return sets;
}

}  // namespace stratum::bench
