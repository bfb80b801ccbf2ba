#include "study/geometry/exact_solid.h"

#include "base/parallel_for.h"

#include <glm/common.hpp>

#include <atomic>
#include <cmath>
#include <random>

namespace stratum::study {

double ExactSolid::clearance(const SurfacePoint& point, double limit) const {
    // Away from the point's own bead distances grow as fast as the way; what makes them shrink again is another wall.
    constexpr double kLeave = 1e-5;  // mm: well above rounding, well below anything printed
    double t = kLeave;
    while (t < limit) {
        const double free = distance(point.position + t * point.normal);
        if (free <= 0.1 * kLeave) return t;
        t += free / slope();
    }
    return limit;
}

ExactSolid::Volume ExactSolid::volume(std::size_t points_of_each, const std::function<Inside()>& other,
                                      int shifts) const {
    // Powers of the root of x^4 = x + 1: M. Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018.
    constexpr double kRoot = 1.22074408460575947536;
    const glm::dvec3 step(1 / kRoot, 1 / (kRoot * kRoot), 1 / (kRoot * kRoot * kRoot));
    const voxelize::Bounds& box = bounds();
    const glm::dvec3 low(box.min[0], box.min[1], box.min[2]);
    const glm::dvec3 size(box.extent(0), box.extent(1), box.extent(2));
    const double each = size.x * size.y * size.z / static_cast<double>(points_of_each);
    std::vector<double> volumes;
    std::vector<double> excesses;
    for (int shift = 0; shift < shifts; ++shift) {
        std::mt19937_64 random(static_cast<std::uint64_t>(shift) + 77);
        std::uniform_real_distribution<double> unit(0, 1);
        const glm::dvec3 start(unit(random), unit(random), unit(random));
        std::atomic<std::int64_t> inside{0};
        std::atomic<std::int64_t> more{0};
        parallelFor(points_of_each, 4096, [&](std::size_t first, std::size_t last) {
            const Inside inside_other = other ? other() : Inside();
            std::int64_t here = 0;
            std::int64_t there = 0;
            for (std::size_t n = first; n != last; ++n) {
                const glm::dvec3 p = low + size * glm::fract(start + step * static_cast<double>(n));
                const int own = distance(p) < 0 ? 1 : 0;
                here += own;
                if (inside_other) there += (inside_other(p) ? 1 : 0) - own;
            }
            inside += here;
            more += there;
        });
        volumes.push_back(each * static_cast<double>(inside));
        excesses.push_back(each * static_cast<double>(more));
    }
    const auto mean = [shifts](const std::vector<double>& values, double& error) {
        double sum = 0;
        for (const double v : values) sum += v / shifts;
        double squares = 0;
        for (const double v : values) squares += (v - sum) * (v - sum);
        error = std::sqrt(squares / (shifts - 1) / shifts);
        return sum;
    };
    Volume result;
    result.value = mean(volumes, result.error);
    result.excess = mean(excesses, result.excess_error);
    return result;
}

}  // namespace stratum::study
