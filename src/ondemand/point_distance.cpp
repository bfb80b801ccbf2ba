#include "ondemand/point_distance.h"

#include "base/error.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/beads/layer_stack.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace stratum::ondemand {

namespace {

// Layers with a bead over or under a point, the last few: those that a weld may join.
class Covers {
public:
    void add(std::uint32_t layer, double offset) {
        if (count_ > 0 && last().layer == layer)
            last().offset = std::min(last().offset, offset);
        else
            places_[count_++ % kKept] = {layer, offset};
    }
    /// The least plan offset of a layer, mm; not negative if no bead of it covers the point.
    double offsetOf(std::uint32_t layer) const {
        for (std::size_t n = 0; n < std::min(count_, kKept); ++n)
            if (places_[n].layer == layer) return places_[n].offset;
        return std::numeric_limits<double>::infinity();
    }

private:
    static constexpr std::size_t kKept = 16;
    struct Place {
        std::uint32_t layer = 0;
        double offset = 0;
    };
    Place& last() { return places_[(count_ - 1) % kKept]; }

    std::array<Place, kKept> places_;
    std::size_t count_ = 0;
};

// The body that two layers share between their center planes. `reach`: no two layers that touch are farther apart.
double weldedAt(const voxelize::LayerStack& stack, const Covers& covers, double z, double reach) {
    const auto center = [&stack](std::uint32_t layer) { return stack.layers[layer].center_z; };
    const auto above = std::partition_point(stack.welds.begin(), stack.welds.end(),
                                            [&](const voxelize::Weld& weld) { return center(weld.upper) <= z; });
    double least = std::numeric_limits<double>::infinity();
    for (auto weld = above; weld != stack.welds.end() && center(weld->upper) - z < reach; ++weld) {
        const double low = center(weld->lower);
        const double high = center(weld->upper);
        if (low >= z) continue;
        const double body = std::max(covers.offsetOf(weld->lower), covers.offsetOf(weld->upper));
        if (body < 0) least = std::min(least, std::max(body, std::abs(z - 0.5 * (low + high)) - 0.5 * (high - low)));
    }
    return least;
}

}  // namespace

PointDistance::PointDistance(const PrintLayout& layout)
    : layout_(layout), reach_((layout.lattice.half_width - 1) * layout.lattice.voxel_size) {
    if (!layout.stack.curves.empty())
        throw UsageError(
            "exact distances of beads that settle: how far a groove fills is found on a lattice; sample a level set");
}

double PointDistance::at(const glm::dvec3& point) const {
    const voxelize::Lattice& lattice = layout_.lattice;
    // Bins hold the beads within the band of their samples; the nearest sample is at most 0.71 voxels away.
    const double i = std::floor(point.x / lattice.voxel_size + 0.5);
    const double j = std::floor(point.y / lattice.voxel_size + 0.5);
    constexpr double kMost = 1e9;
    if (!(std::abs(i) < kMost && std::abs(j) < kMost)) return reach_;
    const auto column = layout_.columnOf(static_cast<int>(i), static_cast<int>(j));
    if (!column) return reach_;
    const voxelize::LayerStack& stack = layout_.stack;
    const gcode::Toolpath& toolpath = *layout_.toolpath;
    double least = reach_;
    Covers covers;
    bool covered = false;
    for (const std::uint32_t rank : layout_.columns.bins()[*column]) {
        if (rank >= stack.first_direct) {
            const voxelize::Extent& extent = stack.extentOf(rank);
            if (point.z < extent.z_min - reach_ || point.z > extent.z_max + reach_) continue;
            const voxelize::BeadField field(toolpath, toolpath.beads[stack.beads[rank]]);
            least = std::min(least, field.distance(point.x, point.y, point.z));
            continue;
        }
        const voxelize::Layer& layer = stack.layers[stack.layer[rank]];
        // With the gap that a weld closes.
        if (std::abs(point.z - layer.center_z) > 2 * layer.halfHeight() + reach_) continue;
        const voxelize::BeadField field(toolpath, toolpath.beads[stack.beads[rank]]);
        const double offset = field.planOffset(point.x, point.y);
        least = std::min(least, field.distance(point.x, point.y, point.z));
        if (offset >= 0) continue;
        covers.add(stack.layer[rank], offset);
        covered = true;
    }
    return covered ? std::min(least, weldedAt(stack, covers, point.z, 2 * layout_.reach)) : least;
}

}  // namespace stratum::ondemand
