#include "trace/box_tree.h"

#include <glm/common.hpp>

#include <utility>

namespace stratum::trace {
namespace {

// Halves before adding, because the sum may overflow.
glm::dvec3 centerOf(const Box& box) { return 0.5 * box.min + 0.5 * box.max; }

}  // namespace

bool hasEnd(const Box& box) {
    for (int axis = 0; axis < 3; ++axis)
        if (!std::isfinite(box.min[axis]) || !std::isfinite(box.max[axis])) return false;
    return true;
}

BoxTree::BoxTree(std::span<const Box> boxes) {
    std::vector<std::uint32_t> ended;
    for (std::uint32_t n = 0; n < boxes.size(); ++n) {
        if (hasEnd(boxes[n]))
            ended.push_back(n);
        else
            endless_.push_back({boxes[n], 0, n});
    }
    if (ended.empty()) return;
    nodes_.reserve(2 * ended.size() - 1);
    build(boxes, ended);
}

void BoxTree::build(std::span<const Box> boxes, std::span<std::uint32_t> indices) {
    const std::size_t place = nodes_.size();
    nodes_.push_back({boxes[indices.front()], 0, indices.size() == 1 ? indices.front() : kInner});
    if (indices.size() > 1) {
        Box centers{centerOf(boxes[indices.front()]), centerOf(boxes[indices.front()])};
        for (const std::uint32_t n : indices) {
            Box& all = nodes_[place].box;
            all.min = glm::min(all.min, boxes[n].min);
            all.max = glm::max(all.max, boxes[n].max);
            centers.min = glm::min(centers.min, centerOf(boxes[n]));
            centers.max = glm::max(centers.max, centerOf(boxes[n]));
        }
        const glm::dvec3 spread = centers.max - centers.min;
        int axis = 0;
        for (const int other : {1, 2})
            if (spread[other] > spread[axis]) axis = other;
        // Equal centers are ordered by index, so that the tree is deterministic.
        const auto before = [&](std::uint32_t a, std::uint32_t b) {
            return std::pair(centerOf(boxes[a])[axis], a) < std::pair(centerOf(boxes[b])[axis], b);
        };
        const std::size_t half = indices.size() / 2;
        std::nth_element(indices.begin(), indices.begin() + static_cast<std::ptrdiff_t>(half), indices.end(), before);
        build(boxes, indices.first(half));
        build(boxes, indices.subspan(half));
    }
    nodes_[place].past = static_cast<std::uint32_t>(nodes_.size());
}

}  // namespace stratum::trace
