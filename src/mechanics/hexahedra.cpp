#include "mechanics/hexahedra.h"

#include "base/error.h"
#include "base/parallel_for.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <tuple>

namespace stratum::mechanics {
namespace {

struct PlanPlace {
    std::int32_t j, i;
    bool operator==(const PlanPlace&) const = default;
    bool operator<(const PlanPlace& other) const { return std::tie(j, i) < std::tie(other.j, other.i); }
};

// The elements of each plane of cubes, and the nodes of each plane of corners.
class Planes {
public:
    explicit Planes(const std::vector<SolidElement>& list)
        : list_(list), low_(list.front().k), count_(static_cast<std::size_t>(list.back().k - low_) + 1) {
        first_.assign(count_ + 1, 0);
        for (const SolidElement& e : list) ++first_[static_cast<std::size_t>(e.k - low_) + 1];
        for (std::size_t p = 0; p < count_; ++p) first_[p + 1] += first_[p];
    }

    std::int32_t low() const { return low_; }
    std::size_t ofCubes() const { return count_; }
    std::size_t ofCorners() const { return count_ + 1; }
    std::size_t firstOf(std::size_t plane) const { return first_[plane]; }
    std::span<const SolidElement> elements(std::size_t plane) const {
        return std::span(list_).subspan(first_[plane], first_[plane + 1] - first_[plane]);
    }

    // The corners of the cubes below and above a plane.
    std::vector<PlanPlace> corners(std::size_t plane) const {
        std::vector<PlanPlace> found;
        for (const std::size_t cubes : {plane - 1, plane}) {
            if (cubes >= count_) continue;  // also below the lowest
            for (const SolidElement& e : elements(cubes))
                for (const std::int32_t dj : {0, 1})
                    for (const std::int32_t di : {0, 1}) found.push_back({e.j + dj, e.i + di});
        }
        std::sort(found.begin(), found.end());
        found.erase(std::unique(found.begin(), found.end()), found.end());
        return found;
    }

private:
    const std::vector<SolidElement>& list_;
    const std::int32_t low_;
    const std::size_t count_;
    std::vector<std::size_t> first_;
};

std::uint32_t numberOf(const PlanPlace& place, const std::vector<PlanPlace>& plane) {
    return static_cast<std::uint32_t>(std::lower_bound(plane.begin(), plane.end(), place) - plane.begin());
}

}  // namespace

Hexahedra hexahedraOf(const SolidElements& elements, std::size_t most_nodes) {
    Hexahedra mesh;
    if (elements.list.empty()) return mesh;
    const Planes planes(elements.list);
    std::vector<std::vector<PlanPlace>> corners(planes.ofCorners());
    parallelFor(corners.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t p = first; p < last; ++p) corners[p] = planes.corners(p);
    });
    std::vector<std::size_t> first(corners.size() + 1);
    for (std::size_t p = 0; p < corners.size(); ++p) first[p + 1] = first[p] + corners[p].size();
    if (first.back() > most_nodes)
        throw UsageError(
            fmt::format("{} nodes are more than the {} that are allowed; choose a larger --voxel-size than "
                        "{:g}, fewer layers or features, or a higher --max-nodes",
                        first.back(), most_nodes, elements.edge));
    mesh.nodes.resize(first.back());
    mesh.corners.resize(elements.list.size());
    parallelFor(corners.size(), 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t p = from; p < to; ++p) {
            for (std::size_t n = 0; n < corners[p].size(); ++n)
                mesh.nodes[first[p] + n] = {corners[p][n].i, corners[p][n].j,
                                            planes.low() + static_cast<std::int32_t>(p)};
            if (p == planes.ofCubes()) continue;
            std::size_t element = planes.firstOf(p);
            for (const SolidElement& e : planes.elements(p)) {
                std::array<std::uint32_t, 8>& of = mesh.corners[element++];
                for (std::size_t side = 0; side < 2; ++side) {
                    const std::vector<PlanPlace>& plane = corners[p + side];
                    const auto base = static_cast<std::uint32_t>(first[p + side]);
                    // The corners of one row follow each other, since both are there.
                    const std::uint32_t near = base + numberOf({e.j, e.i}, plane);
                    const std::uint32_t far = base + numberOf({e.j + 1, e.i}, plane);
                    of[4 * side] = near;
                    of[4 * side + 1] = near + 1;
                    of[4 * side + 2] = far + 1;
                    of[4 * side + 3] = far;
                }
            }
        }
    });
    return mesh;
}

}  // namespace stratum::mechanics
