#include "compare/surface_samples.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace stratum::compare {
namespace {

// The additive recurrence of the plastic number fills a square evenly (Roberts, "The unreasonable effectiveness of
// quasirandom sequences", 2018).
constexpr double kFirst = 0.7548776662466927;
constexpr double kSecond = 0.5698402909980532;

double fraction(double x) { return x - std::floor(x); }

double medianOf(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

SurfaceSampler::SurfaceSampler(const TriangleMesh& mesh) : mesh_(mesh) {
    until_.reserve(mesh.triangles.size());
    double area = 0;
    for (const Triangle& t : mesh.triangles) {
        area += 0.5 * glm::length(mesh.areaNormal(t));
        until_.push_back(area);
    }
}

SurfaceSamples SurfaceSampler::operator()(std::size_t count) const {
    SurfaceSamples samples;
    if (until_.empty()) return samples;
    samples.area = until_.back();
    if (!(samples.area > 0)) return samples;
    samples.points.reserve(count);
    samples.triangles.reserve(count);
    std::size_t triangle = 0;
    for (std::size_t n = 0; n < count; ++n) {
        const double at = samples.area * (static_cast<double>(n) + 0.5) / static_cast<double>(count);
        while (triangle + 1 < until_.size() && until_[triangle] < at) ++triangle;
        // Uniform in the triangle: the square root makes the first coordinate's density linear.
        const double root = std::sqrt(fraction(kFirst * static_cast<double>(n + 1)));
        const double other = fraction(kSecond * static_cast<double>(n + 1));
        const Triangle& t = mesh_.triangles[triangle];
        samples.points.push_back(mesh_.corner(t, 0) * (1 - root) + mesh_.corner(t, 1) * (root * (1 - other)) +
                                 mesh_.corner(t, 2) * (root * other));
        samples.triangles.push_back(static_cast<std::uint32_t>(triangle));
    }
    return samples;
}

SurfaceSamples sampleSurface(const TriangleMesh& mesh, std::size_t count) { return SurfaceSampler(mesh)(count); }

SurfaceSamples thinned(const SurfaceSamples& samples, std::size_t count) {
    const std::size_t all = samples.points.size();
    if (all <= count) return samples;
    SurfaceSamples fewer;
    fewer.area = samples.area;
    for (std::size_t n = 0; n < count; ++n) {
        const std::size_t at = n * all / count;
        fewer.points.push_back(samples.points[at]);
        fewer.triangles.push_back(samples.triangles[at]);
    }
    return fewer;
}

double spreadOf(const SurfaceSamples& samples) {
    if (samples.points.empty()) return 0;
    std::vector<double> values(samples.points.size());
    glm::dvec3 middle(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        for (std::size_t n = 0; n < values.size(); ++n) values[n] = samples.points[n][axis];
        middle[axis] = medianOf(values);
    }
    for (std::size_t n = 0; n < values.size(); ++n) values[n] = glm::length(samples.points[n] - middle);
    return medianOf(values);
}

}  // namespace stratum::compare
