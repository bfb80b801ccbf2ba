#include "compare/closed_model.h"

#include "base/error.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

namespace stratum::compare {
namespace {

struct Edge {
    std::uint32_t low, high;  // points
    std::uint32_t triangle;
    std::uint8_t corner;  // it begins at
    bool forward;         // from low to high
    auto ends() const { return std::tie(low, high); }
};

}  // namespace

ClosedModel::ClosedModel(TriangleMesh mesh, const std::string& name) : mesh_(std::move(mesh)), tree_(mesh_) {
    joinEdges(name);
    normals_.reserve(mesh_.triangles.size());
    corner_normals_.assign(mesh_.points.size(), glm::dvec3(0.0));
    // Relative to a point of the mesh: models may lie far from the origin.
    const glm::dvec3 origin = mesh_.points.front();
    for (const Triangle& t : mesh_.triangles) {
        const glm::dvec3 normal = mesh_.areaNormal(t);
        const double length = glm::length(normal);
        const glm::dvec3 unit = length > 0 ? normal / length : glm::dvec3(0.0);
        normals_.push_back(unit);
        area_ += 0.5 * length;
        volume_ += glm::dot(mesh_.corner(t, 0) - origin, normal) / 6;
        for (std::size_t n = 0; n < 3; ++n) {
            const glm::dvec3 a = mesh_.corner(t, (n + 1) % 3) - mesh_.corner(t, n);
            const glm::dvec3 b = mesh_.corner(t, (n + 2) % 3) - mesh_.corner(t, n);
            corner_normals_[t[n]] += unit * std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
        }
    }
    if (!(volume_ > 0))
        throw InputError(
            fmt::format("{}: is inside out or flat: its triangles enclose {:.4g} mm3; turn its faces over, "
                        "and export it again",
                        name, volume_));
}

void ClosedModel::joinEdges(const std::string& name) {
    std::vector<Edge> edges;
    edges.reserve(3 * mesh_.triangles.size());
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
        for (std::uint8_t n = 0; n < 3; ++n) {
            const std::uint32_t from = mesh_.triangles[t][n];
            const std::uint32_t to = mesh_.triangles[t][(n + 1) % 3];
            edges.push_back({std::min(from, to), std::max(from, to), t, n, from < to});
        }
    // Forward ones first; those of an edge of many triangles are joined in their order.
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
        return std::tie(a.low, a.high, b.forward, a.triangle) < std::tie(b.low, b.high, a.forward, b.triangle);
    });
    beside_.assign(mesh_.triangles.size(), {Nearest::kNone, Nearest::kNone, Nearest::kNone});
    std::size_t open = 0;
    glm::dvec3 place(0.0);
    for (std::size_t first = 0; first < edges.size();) {
        std::size_t last = first;
        std::size_t forward = 0;
        for (; last < edges.size() && edges[last].ends() == edges[first].ends(); ++last)
            forward += edges[last].forward ? 1 : 0;
        if (2 * forward != last - first) {
            if (open++ == 0) place = 0.5 * (mesh_.points[edges[first].low] + mesh_.points[edges[first].high]);
        } else {
            for (std::size_t n = first; n < first + forward; ++n) {
                const Edge& one = edges[n];
                const Edge& other = edges[n + forward];
                beside_[one.triangle][one.corner] = other.triangle;
                beside_[other.triangle][other.corner] = one.triangle;
            }
        }
        first = last;
    }
    if (open > 0)
        throw InputError(
            fmt::format("{}: is not closed: {} edges have a triangle on one side only, the first at ({:.3f}, "
                        "{:.3f}, {:.3f}) mm; repair the model, and export it again",
                        name, open, place.x, place.y, place.z));
}

ModelDistance ClosedModel::distance(const glm::dvec3& p, std::uint32_t hint) const {
    const Nearest nearest = tree_.nearest(p, hint);
    const Triangle& t = mesh_.triangles[nearest.triangle];
    glm::dvec3 normal = normals_[nearest.triangle];
    const auto edge = [&](std::size_t n) { return normal + normals_[beside_[nearest.triangle][n]]; };
    switch (nearest.feature) {
        case 1:
        case 2:
        case 4:
            normal = corner_normals_[t[nearest.feature >> 1]];
            break;
        case 1 | 2:
            normal = edge(0);
            break;
        case 2 | 4:
            normal = edge(1);
            break;
        case 1 | 4:
            normal = edge(2);
            break;
        default:
            break;
    }
    const double distance = std::sqrt(nearest.distance2);
    return {glm::dot(p - nearest.point, normal) < 0 ? -distance : distance, nearest.triangle, nearest.point};
}

}  // namespace stratum::compare
