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

glm::dvec3 TriangleMesh::areaNormal(const Triangle& triangle) const {
    const glm::dvec3 a = corner(triangle, 0);
    return glm::cross(corner(triangle, 1) - a, corner(triangle, 2) - a);
}

namespace {

constexpr double kRoughly = 0.99;
constexpr std::size_t kDeepest = 64;  // the median halves 2^32 triangles 32 times

bool joined(const Triangle& a, const Triangle& b) {
    return std::any_of(a.begin(), a.end(),
                       [&b](std::uint32_t corner) { return corner == b[0] || corner == b[1] || corner == b[2]; });
}

float below(double value) {
    const auto near = static_cast<float>(value);
    return static_cast<double>(near) <= value ? near : std::nextafter(near, -std::numeric_limits<float>::infinity());
}
float above(double value) { return -below(-value); }

Nearest found(const glm::dvec3& p, const glm::dvec3& point, std::uint8_t feature) {
    Nearest nearest;
    nearest.point = point;
    const glm::dvec3 to = p - point;
    nearest.distance2 = glm::dot(to, to);
    nearest.feature = feature;
    return nearest;
}

}  // namespace

Nearest nearestOn(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const glm::dvec3 ab = b - a;
    const glm::dvec3 ac = c - a;
    // Along both edges from each corner.
    const double ab_a = glm::dot(ab, p - a);
    const double ac_a = glm::dot(ac, p - a);
    if (ab_a <= 0 && ac_a <= 0) return found(p, a, 1);
    const double ab_b = glm::dot(ab, p - b);
    const double ac_b = glm::dot(ac, p - b);
    if (ab_b >= 0 && ac_b <= ab_b) return found(p, b, 2);
    const double ab_c = glm::dot(ab, p - c);
    const double ac_c = glm::dot(ac, p - c);
    if (ac_c >= 0 && ab_c <= ac_c) return found(p, c, 4);
    // Signed areas towards each edge: barycentric coordinates, times the area.
    const double towards_c = ab_a * ac_b - ab_b * ac_a;
    if (towards_c <= 0 && ab_a >= 0 && ab_b <= 0) return found(p, a + ab * (ab_a / (ab_a - ab_b)), 1 | 2);
    const double towards_b = ab_c * ac_a - ab_a * ac_c;
    if (towards_b <= 0 && ac_a >= 0 && ac_c <= 0) return found(p, a + ac * (ac_a / (ac_a - ac_c)), 1 | 4);
    const double towards_a = ab_b * ac_c - ab_c * ac_b;
    const double from_b = ac_b - ab_b;
    const double from_c = ab_c - ac_c;
    if (towards_a <= 0 && from_b >= 0 && from_c >= 0)
        return found(p, b + (c - b) * (from_b / (from_b + from_c)), 2 | 4);
    const double sum = towards_a + towards_b + towards_c;
    return found(p, a + ab * (towards_b / sum) + ac * (towards_c / sum), 1 | 2 | 4);
}

TriangleTree::TriangleTree(const TriangleMesh& mesh, std::uint32_t leaf) : mesh_(mesh) {
    std::vector<Run> all = runs(leaf);
    nodes_.reserve(2 * all.size());
    if (!all.empty()) build(all);
}

std::vector<TriangleTree::Run> TriangleTree::runs(std::uint32_t leaf) const {
    std::vector<Run> runs;
    const auto count = static_cast<std::uint32_t>(mesh_.triangles.size());
    runs.reserve(std::size_t{2} * (count / leaf));
    for (std::uint32_t begin = 0; begin < count;) {
        glm::dvec3 sum(0.0);
        std::uint32_t end = begin;
        do {
            const Triangle& t = mesh_.triangles[end++];
            sum += mesh_.corner(t, 0) + mesh_.corner(t, 1) + mesh_.corner(t, 2);
        } while (end < count && end - begin < leaf && joined(mesh_.triangles[end - 1], mesh_.triangles[end]));
        const glm::vec3 middle(sum / (3.0 * (end - begin)));
        runs.push_back({{middle.x, middle.y, middle.z}, begin, end});
        begin = end;
    }
    return runs;
}

// Boxes are made from the leaves up: each triangle is read once.
std::uint32_t TriangleTree::build(std::span<Run> runs) {
    const auto number = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back(runs.size() == 1 ? leafOf(runs.front()) : Node{});
    if (runs.size() == 1) return number;
    std::array<float, 3> low = runs.front().middle;
    std::array<float, 3> high = low;
    for (const Run& run : runs)
        for (std::size_t n = 0; n < 3; ++n) {
            low[n] = std::min(low[n], run.middle[n]);
            high[n] = std::max(high[n], run.middle[n]);
        }
    const std::array<float, 3> size = {high[0] - low[0], high[1] - low[1], high[2] - low[2]};
    const std::size_t axis = size[0] >= size[1] && size[0] >= size[2] ? 0 : size[1] >= size[2] ? 1 : 2;
    const std::size_t half = runs.size() / 2;
    std::nth_element(
        runs.begin(), runs.begin() + static_cast<std::ptrdiff_t>(half), runs.end(), [axis](const Run& a, const Run& b) {
            return a.middle[axis] < b.middle[axis] || (a.middle[axis] == b.middle[axis] && a.begin < b.begin);
        });
    const std::uint32_t left = build(runs.first(half));
    const std::uint32_t right = build(runs.subspan(half));
    Node& node = nodes_[number];
    node.right = right;
    for (int n = 0; n < 3; ++n) {
        node.low[n] = std::min(nodes_[left].low[n], nodes_[right].low[n]);
        node.high[n] = std::max(nodes_[left].high[n], nodes_[right].high[n]);
    }
    return number;
}

TriangleTree::Node TriangleTree::leafOf(const Run& run) const {
    glm::dvec3 low(std::numeric_limits<double>::infinity());
    glm::dvec3 high(-low);
    for (std::uint32_t t = run.begin; t < run.end; ++t)
        for (const std::uint32_t corner : mesh_.triangles[t]) {
            low = glm::min(low, mesh_.points[corner]);
            high = glm::max(high, mesh_.points[corner]);
        }
    return {{below(low.x), below(low.y), below(low.z)},
            {above(high.x), above(high.y), above(high.z)},
            run.begin,
            run.end,
            0};
}

double TriangleTree::distance2(const Node& node, const glm::dvec3& p) {
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double out = std::max(
            {static_cast<double>(node.low[axis]) - p[axis], p[axis] - static_cast<double>(node.high[axis]), 0.0});
        sum += out * out;
    }
    return sum;
}

void TriangleTree::test(std::uint32_t triangle, const glm::dvec3& p, Nearest& best) const {
    const Triangle& t = mesh_.triangles[triangle];
    Nearest here = nearestOn(p, mesh_.corner(t, 0), mesh_.corner(t, 1), mesh_.corner(t, 2));
    here.triangle = triangle;
    // Of equally near ones the first, so that the result does not depend on the hint.
    if (std::pair(here.distance2, here.triangle) < std::pair(best.distance2, best.triangle)) best = here;
}

Nearest TriangleTree::nearest(const glm::dvec3& p, std::uint32_t hint, double rough) const {
    Nearest best;
    if (nodes_.empty()) return best;
    std::uint32_t looked_at = 0;
    if (hint != Nearest::kNone) test(hint, p, best);
    struct Waiting {
        std::uint32_t node;
        double distance2;
    };
    const auto reach2 = [&best, rough2 = rough * rough] {
        return best.distance2 > rough2 ? kRoughly * kRoughly * best.distance2 : best.distance2;
    };
    std::array<Waiting, kDeepest> stack;
    std::size_t waiting = 0;
    stack[waiting++] = {0, distance2(nodes_[0], p)};
    while (waiting > 0) {
        const Waiting next = stack[--waiting];
        if (next.distance2 > reach2()) continue;
        ++looked_at;
        const Node& node = nodes_[next.node];
        if (node.right == 0) {
            for (std::uint32_t n = node.begin; n < node.end; ++n) test(n, p, best);
            looked_at += node.end - node.begin;
            continue;
        }
        Waiting near{next.node + 1, distance2(nodes_[next.node + 1], p)};
        Waiting far{node.right, distance2(nodes_[node.right], p)};
        if (far.distance2 < near.distance2) std::swap(near, far);
        if (far.distance2 <= reach2()) stack[waiting++] = far;
        if (near.distance2 <= reach2()) stack[waiting++] = near;
    }
    best.looked_at = looked_at;
    return best;
}

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
