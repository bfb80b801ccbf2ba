#include "compare/closed_model.h"

#include "base/error.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
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

// A triangle whose area is less than this share of its longest edge's square has no normal to rely on.
constexpr double kFlat = 1e-10;

}  // namespace

ClosedModel::ClosedModel(TriangleMesh mesh, const std::string& name) : mesh_(std::move(mesh)), tree_(mesh_) {
    joinEdges(name);
    addNormals();
    addCornerNormals();
    countRepeated();
    if (!(volume_ > 0))
        throw InputError(
            fmt::format("{}: is inside out or flat: its triangles enclose {:.4g} mm3; turn its faces over, "
                        "and export it again",
                        name, volume_));
}

void ClosedModel::addNormals() {
    normals_.reserve(mesh_.triangles.size());
    flat_.reserve(mesh_.triangles.size());
    // Relative to a point of the mesh: models may lie far from the origin.
    const glm::dvec3 origin = mesh_.points.front();
    for (const Triangle& t : mesh_.triangles) {
        const glm::dvec3 normal = mesh_.areaNormal(t);
        const double length = glm::length(normal);
        std::size_t longest = 0;
        double longest2 = 0;
        for (std::size_t n = 0; n < 3; ++n) {
            const glm::dvec3 edge = mesh_.corner(t, (n + 1) % 3) - mesh_.corner(t, n);
            if (glm::dot(edge, edge) > longest2) longest2 = glm::dot(edge, edge), longest = n;
        }
        const bool flat = length <= kFlat * longest2;
        flat_.push_back(flat ? static_cast<std::uint8_t>(longest) : kNotFlat);
        normals_.push_back(flat ? glm::dvec3(0.0) : normal / length);
        area_ += 0.5 * length;
        volume_ += glm::dot(mesh_.corner(t, 0) - origin, normal) / 6;
    }
}

void ClosedModel::addCornerNormals() {
    corner_normals_.assign(mesh_.points.size(), glm::dvec3(0.0));
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
        const Triangle& corners = mesh_.triangles[t];
        if (flat_[t] != kNotFlat) {
            // The corner between the ends of its line: the face beyond goes on there.
            const std::uint32_t between = corners[(flat_[t] + 2U) % 3];
            normals_[t] = beyond(t, flat_[t], mesh_.points[between]);
            corner_normals_[between] += std::numbers::pi * normals_[t];
            continue;
        }
        for (std::size_t n = 0; n < 3; ++n) {
            const glm::dvec3 a = mesh_.corner(corners, (n + 1) % 3) - mesh_.corner(corners, n);
            const glm::dvec3 b = mesh_.corner(corners, (n + 2) % 3) - mesh_.corner(corners, n);
            corner_normals_[corners[n]] += normals_[t] * std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
        }
    }
}

void ClosedModel::countRepeated() {
    std::vector<Triangle> turned = mesh_.triangles;
    for (Triangle& t : turned) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    std::sort(turned.begin(), turned.end());
    for (std::size_t n = 1; n < turned.size(); ++n) repeated_ += turned[n] == turned[n - 1] ? 1 : 0;
}

// Of the two short edges of a triangle without area that on which the place lies.
std::size_t ClosedModel::shortEdge(std::uint32_t flat, const glm::dvec3& at) const {
    const Triangle& corners = mesh_.triangles[flat];
    const std::size_t longest = flat_[flat];
    const std::size_t between = (longest + 2) % 3;
    const glm::dvec3 middle = mesh_.corner(corners, between);
    const glm::dvec3 begin = mesh_.corner(corners, longest);
    return glm::dot(at - middle, begin - middle) > 0 ? between : (longest + 1) % 3;
}

// The normal of the first face with area beyond an edge, near a place on it.
glm::dvec3 ClosedModel::beyond(std::uint32_t triangle, std::size_t edge, const glm::dvec3& at) const {
    constexpr int kMostFlat = 64;  // one behind the other; a ring of them has no end
    for (int step = 0; step < kMostFlat; ++step) {
        const std::uint32_t from = mesh_.triangles[triangle][(edge + 1) % 3];
        triangle = beside_[triangle][edge];
        if (flat_[triangle] == kNotFlat) return normals_[triangle];
        std::size_t entered = 0;
        while (entered < 2 && mesh_.triangles[triangle][entered] != from) ++entered;
        edge = entered == flat_[triangle] ? shortEdge(triangle, at) : flat_[triangle];
    }
    return glm::dvec3(0.0);
}

glm::dvec3 ClosedModel::lineNormal(std::uint32_t flat, const glm::dvec3& at) const {
    return beyond(flat, flat_[flat], at) + beyond(flat, shortEdge(flat, at), at);
}

glm::dvec3 ClosedModel::edgeNormal(const Nearest& nearest, std::size_t edge) const {
    const std::uint32_t other = beside_[nearest.triangle][edge];
    if (flat_[other] != kNotFlat) {
        // The corner of the line beyond may be the place.
        const Triangle& corners = mesh_.triangles[other];
        const std::uint32_t between = corners[(flat_[other] + 2U) % 3];
        const glm::dvec3 off = mesh_.points[between] - nearest.point;
        const glm::dvec3 line = mesh_.corner(corners, flat_[other]) - mesh_.points[between];
        if (glm::dot(off, off) <= kFlat * kFlat * glm::dot(line, line)) return corner_normals_[between];
    }
    return normals_[nearest.triangle] + beyond(nearest.triangle, edge, nearest.point);
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

ModelDistance ClosedModel::distance(const glm::dvec3& p, std::uint32_t hint, double rough) const {
    const Nearest nearest = tree_.nearest(p, hint, rough);
    const Triangle& t = mesh_.triangles[nearest.triangle];
    glm::dvec3 normal = normals_[nearest.triangle];
    if (std::has_single_bit(nearest.feature))
        normal = corner_normals_[t[nearest.feature >> 1]];
    else if (flat_[nearest.triangle] != kNotFlat)
        normal = lineNormal(nearest.triangle, nearest.point);
    else if (nearest.feature != (1 | 2 | 4))
        normal = edgeNormal(nearest, nearest.feature == (1 | 2) ? 0 : nearest.feature == (2 | 4) ? 1 : 2);
    const double distance = std::sqrt(nearest.distance2);
    return {glm::dot(p - nearest.point, normal) < 0 ? -distance : distance, nearest.triangle, nearest.point};
}

}  // namespace stratum::compare
