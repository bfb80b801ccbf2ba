#include "ondemand/active_box.h"

#include "base/parallel_for.h"
#include "voxelize/beads/bead_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <vector>

namespace stratum::ondemand {
namespace {

// Samples that a bead's band can reach, in index space; never too few.
using Reach = openvdb::CoordBBox;

Reach reachOf(const PrintLayout& layout, std::uint32_t rank) {
    const voxelize::Lattice& lattice = layout.lattice;
    const gcode::Toolpath& toolpath = *layout.toolpath;
    const gcode::Bead& bead = toolpath.beads[layout.stack.beads[rank]];
    const voxelize::BeadField field(toolpath, bead);
    const voxelize::Bounds solid = field.bounds();
    const double h = lattice.voxel_size;
    double around = lattice.background();
    double raised = 0;
    if (rank < layout.stack.first_direct) {
        // The widest sampled section need not be the widest section.
        const double center = 0.5 * (solid.min[2] + solid.max[2]);
        const double off = std::max(std::abs(std::remainder(center - lattice.origin_z, h)) - field.halfSide(), 0.0);
        const double far = field.radius() + lattice.background();
        around = std::sqrt(far * far - off * off) - field.radius();
        if (toolpath.deposit.swells()) around += voxelize::kMostSwell;
        raised = layout.stack.layers[layout.stack.layer[rank]].most_rise;
    }
    constexpr double kSlack = 1e-4;  // voxels; the leaves give the exact box
    Reach reach;
    for (int axis = 0; axis < 3; ++axis) {
        const double origin = axis == 2 ? lattice.origin_z : 0;
        const double more = axis == 2 ? lattice.background() : around;
        reach.min()[axis] = static_cast<int>(std::ceil((solid.min[axis] - more - origin) / h - kSlack));
        const double above = axis == 2 ? raised : 0;
        reach.max()[axis] = static_cast<int>(std::floor((solid.max[axis] + above + more - origin) / h + kSlack));
    }
    return reach;
}

class Search {
public:
    explicit Search(const PrintLayout& layout) : layout_(layout), maker_(layout), reaches_(layout.stack.beads.size()) {
        constexpr std::size_t kGrain = 4096;
        parallelFor(reaches_.size(), kGrain, [&](std::size_t first, std::size_t last) {
            for (std::size_t rank = first; rank != last; ++rank)
                reaches_[rank] = reachOf(layout, static_cast<std::uint32_t>(rank));
        });
        for (const Reach& reach : reaches_) all_.expand(reach);
    }

    // The outermost plane of samples across `axis` with an active one.
    int find(int axis, bool high) {
        const int step = high ? -1 : 1;
        const int last = high ? all_.min()[axis] : all_.max()[axis];
        for (int plane = high ? all_.max()[axis] : all_.min()[axis]; plane != last + step; plane += step)
            for (std::size_t rank = 0; rank < reaches_.size(); ++rank)
                if (plane >= reaches_[rank].min()[axis] && plane <= reaches_[rank].max()[axis] &&
                    beadIsActive(static_cast<std::uint32_t>(rank), axis, plane))
                    return plane;
        return last;
    }

private:
    // Whether the bead's surroundings have an active sample in that plane.
    bool beadIsActive(std::uint32_t rank, int axis, int plane) {
        const gcode::Bead& bead = layout_.toolpath->beads[layout_.stack.beads[rank]];
        const Reach& reach = reaches_[rank];
        const auto indexOf = [&](double x, double y) {
            const double h = layout_.lattice.voxel_size;
            openvdb::Coord at(static_cast<int>(std::lround(x / h)), static_cast<int>(std::lround(y / h)),
                              (reach.min()[2] + reach.max()[2]) / 2);
            at[axis] = plane;
            return at & ~(voxelize::kLeafDim - 1);
        };
        // Most likely first.
        const openvdb::Coord likely[] = {indexOf(bead.x0, bead.y0), indexOf(bead.x1, bead.y1),
                                         indexOf(0.5 * (bead.x0 + bead.x1), 0.5 * (bead.y0 + bead.y1))};
        for (const openvdb::Coord& leaf : likely)
            if (leafIsActive(leaf, axis, plane)) return true;
        openvdb::Coord low = reach.min();
        openvdb::Coord high = reach.max();
        low[axis] = high[axis] = plane;
        low = low & ~(voxelize::kLeafDim - 1);
        for (int i = low[0]; i <= high[0]; i += voxelize::kLeafDim)
            for (int j = low[1]; j <= high[1]; j += voxelize::kLeafDim)
                for (int k = low[2]; k <= high[2]; k += voxelize::kLeafDim)
                    if (leafIsActive({i, j, k}, axis, plane)) return true;
        return false;
    }

    bool leafIsActive(const openvdb::Coord& leaf, int axis, int plane) {
        const auto [known, first] = active_.try_emplace(leaf);
        if (first) known->second = activeIn(leaf);
        return known->second[static_cast<std::size_t>(axis)] >> (plane & 7) & 1;
    }

    // Which planes of a leaf across each axis have active samples.
    std::array<unsigned, 3> activeIn(const openvdb::Coord& leaf) {
        std::array<unsigned, 3> planes{};
        if (maker_.make(leaf, std::numeric_limits<std::uint32_t>::max()) != voxelize::LeafContent::surface)
            return planes;
        const auto background = static_cast<float>(layout_.lattice.background() * layout_.unit);
        const voxelize::LeafPlanes& phi = maker_.column().planes();
        for (std::size_t z = 0; z < voxelize::kLeafPlanes; ++z)
            for (std::size_t c = 0; c < voxelize::kColumnSamples; ++c) {
                if (!(std::abs(phi.plane[z].v[c]) < background)) continue;
                planes[0] |= 1U << (c >> 3);
                planes[1] |= 1U << (c & 7);
                planes[2] |= 1U << z;
            }
        return planes;
    }

    const PrintLayout& layout_;
    LeafMaker maker_;
    std::vector<Reach> reaches_;
    Reach all_;
    std::map<openvdb::Coord, std::array<unsigned, 3>> active_;  // of leaves looked at
};

}  // namespace

openvdb::CoordBBox findActiveBox(const PrintLayout& layout) {
    Search search(layout);
    openvdb::CoordBBox box;
    for (int axis = 0; axis < 3; ++axis) {
        box.min()[axis] = search.find(axis, false);
        box.max()[axis] = search.find(axis, true);
    }
    return box;
}

}  // namespace stratum::ondemand
