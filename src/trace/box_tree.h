// A bounding volume hierarchy over whole objects: finds the boxes that a ray meets.
#pragma once

#include "trace/intersector.h"

#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace stratum::trace {

/// Whether the box is finite on every side.
bool hasEnd(const Box& box);

/// One ray against boxes: slabs, with the divisions done once (Kay and Kajiya, SIGGRAPH 1986).
class BoxTest {
public:
    explicit BoxTest(const Ray& ray) : origin_(ray.origin), inverse_(1.0 / ray.direction), t_min_(ray.t_min) {}

    /// Whether the ray meets the box no later than at `t_max`. Conservative: true in doubt. Every operation is
    /// monotonic in the box, even when rounded, so a ray that meets a box meets every enclosing box.
    bool meets(const Box& box, double t_max) const {
        double near = t_min_;
        double far = t_max;
        for (int axis = 0; axis < 3; ++axis) {
            // Avoids 0 * inf: along such an axis the ray doesn't move, or takes t > 10^308 to.
            if (!std::isfinite(inverse_[axis])) {
                if (origin_[axis] < box.min[axis] || origin_[axis] > box.max[axis]) return false;
                continue;
            }
            const double a = (box.min[axis] - origin_[axis]) * inverse_[axis];
            const double b = (box.max[axis] - origin_[axis]) * inverse_[axis];
            near = std::max(near, std::min(a, b));
            far = std::min(far, std::max(a, b));
        }
        // Three rounding errors each; the exact values may be in the other order.
        constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();
        return near - std::abs(near) * kRounding <= far + std::abs(far) * kRounding;
    }

private:
    glm::dvec3 origin_;
    glm::dvec3 inverse_;
    double t_min_;
};

/// Immutable; shared by all threads. Split at the median of the centers along the axis of their largest spread, so its
/// depth is at most log2 of the number of boxes, rounded up; a leaf is one box. Nodes are stored depth first with the
/// index of the node to continue at after a miss, so that traversal needs no stack.
class BoxTree {
public:
    /// @param boxes  min <= max on each axis; any number. Infinite ones are kept outside the tree.
    explicit BoxTree(std::span<const Box> boxes);

    /// Calls stop(index) for each box that the ray meets no later than at `t_max`, in arbitrary order, until it returns
    /// true. Returns whether it did.
    template <typename Stop>
    bool visit(const BoxTest& ray, double t_max, const Stop& stop) const {
        for (const Node& node : endless_)
            if (ray.meets(node.box, t_max) && stop(node.leaf)) return true;
        for (std::uint32_t n = 0; n < nodes_.size();) {
            const Node& node = nodes_[n];
            if (!ray.meets(node.box, t_max)) {
                n = node.past;
                continue;
            }
            if (node.leaf != kInner && stop(node.leaf)) return true;
            ++n;
        }
        return false;
    }

    std::size_t bytes() const { return nodes_.size() * sizeof(Node) + endless_.size() * sizeof(Node); }

private:
    static constexpr std::uint32_t kInner = ~std::uint32_t{0};
    struct Node {
        Box box;
        std::uint32_t past;  ///< the node after all descendants of this one
        std::uint32_t leaf;  ///< index of the box, or kInner
    };

    void build(std::span<const Box> boxes, std::span<std::uint32_t> indices);

    std::vector<Node> nodes_;
    std::vector<Node> endless_;
};

}  // namespace stratum::trace
