#include "compare/nearest_triangle.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace stratum::compare {
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

}  // namespace stratum::compare
