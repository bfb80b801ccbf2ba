#include "ondemand/brick_map.h"

#include "base/error.h"
#include "base/parallel_for.h"
#include "march/brick/brick_grid.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/beads/footprint.h"
#include "voxelize/swell/swell_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>
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
        if (toolpath.deposit.swells()) around += voxelize::kMostSwell * layout.stack.settling_scale;
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
    explicit Search(const PrintLayout& layout) : layout_(layout), reaches_(layout.stack.beads.size()) {
        constexpr std::size_t kGrain = 4096;
        parallelFor(reaches_.size(), kGrain, [&](std::size_t first, std::size_t last) {
            for (std::size_t rank = first; rank != last; ++rank)
                reaches_[rank] = reachOf(layout, static_cast<std::uint32_t>(rank));
        });
        for (const Reach& reach : reaches_) all_.expand(reach);
    }

    // The outermost plane of samples across `axis` with an active one.
    int find(int axis, bool high) const {
        Leaves leaves(layout_);
        const int step = high ? -1 : 1;
        const int last = high ? all_.min()[axis] : all_.max()[axis];
        for (int plane = high ? all_.max()[axis] : all_.min()[axis]; plane != last + step; plane += step)
            for (std::size_t rank = 0; rank < reaches_.size(); ++rank)
                if (plane >= reaches_[rank].min()[axis] && plane <= reaches_[rank].max()[axis] &&
                    beadIsActive(leaves, static_cast<std::uint32_t>(rank), axis, plane))
                    return plane;
        return last;
    }

private:
    // Leaves that one search looks at.
    struct Leaves {
        explicit Leaves(const PrintLayout& layout) : maker(layout) {}
        LeafMaker maker;
        std::map<openvdb::Coord, std::array<unsigned, 3>> active;
    };

    // Whether the bead's surroundings have an active sample in that plane.
    bool beadIsActive(Leaves& leaves, std::uint32_t rank, int axis, int plane) const {
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
            if (leafIsActive(leaves, leaf, axis, plane)) return true;
        openvdb::Coord low = reach.min();
        openvdb::Coord high = reach.max();
        low[axis] = high[axis] = plane;
        low = low & ~(voxelize::kLeafDim - 1);
        for (int i = low[0]; i <= high[0]; i += voxelize::kLeafDim)
            for (int j = low[1]; j <= high[1]; j += voxelize::kLeafDim)
                for (int k = low[2]; k <= high[2]; k += voxelize::kLeafDim)
                    if (leafIsActive(leaves, {i, j, k}, axis, plane)) return true;
        return false;
    }

    bool leafIsActive(Leaves& leaves, const openvdb::Coord& leaf, int axis, int plane) const {
        const auto [known, first] = leaves.active.try_emplace(leaf);
        if (first) known->second = activeIn(leaves.maker, leaf);
        return known->second[static_cast<std::size_t>(axis)] >> (plane & 7) & 1;
    }

    // Which planes of a leaf across each axis have active samples.
    std::array<unsigned, 3> activeIn(LeafMaker& maker, const openvdb::Coord& leaf) const {
        std::array<unsigned, 3> planes{};
        if (maker.make(leaf, std::numeric_limits<std::uint32_t>::max()) != voxelize::LeafContent::surface)
            return planes;
        const auto background = static_cast<float>(layout_.lattice.background() * layout_.unit);
        const voxelize::LeafPlanes& phi = maker.column().planes();
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
    std::vector<Reach> reaches_;
    Reach all_;
};

}  // namespace

openvdb::CoordBBox findActiveBox(const PrintLayout& layout) {
    if (layout.stack.swell != nullptr) layout.stack.swell->list(*layout.toolpath, layout.stack);
    const Search search(layout);
    openvdb::CoordBBox box;
    parallelFor(6, 1, [&](std::size_t first, std::size_t last) {
        for (auto n = static_cast<int>(first); n < static_cast<int>(last); ++n)
            (n % 2 == 0 ? box.min() : box.max())[n / 2] = search.find(n / 2, n % 2 != 0);
    });
    return box;
}

namespace {

constexpr int kBrick = 8;   // cells
constexpr int kMacro = 32;  // cells
constexpr int kBricks = kMacro / kBrick;
constexpr double kSlack = 1e-3;  // voxels, against rounding

// Bricks [first, last] along z, from the map's origin.
using Run = std::pair<int, int>;

class Mapper {
public:
    Mapper(const PrintLayout& layout, const openvdb::CoordBBox& active, PrintMap& result)
        : layout_(layout),
          map_(result.bricks),
          first_bead_(result.first_bead),
          low_((active.min() & ~(kBrick - 1)) - map_.origin),
          high_((active.max() & ~(kBrick - 1)) - map_.origin),
          // The samples of a brick are nine along each axis: those of its cells' corners.
          footprints_(*layout.toolpath, kBrick * layout.lattice.voxel_size, 0.5 * kBrick * layout.lattice.voxel_size,
                      kSlack * layout.lattice.voxel_size, voxelize::Footprints::Reach::solid) {
        for (int axis = 0; axis < 3; ++axis) {
            low_[axis] /= kBrick;
            high_[axis] /= kBrick;
        }
        first_i_ = map_.origin[0] / kBrick;
        first_j_ = map_.origin[1] / kBrick;
    }

    // Beads by the macro slabs across z that they reach: beads of layers as intervals of ranks, direct beads as lists.
    void listSlabs() {
        const voxelize::LayerStack& stack = layout_.stack;
        slabs_.resize(static_cast<std::size_t>(map_.macros[2]));
        for (const voxelize::Layer& layer : stack.layers) {
            const double gap = 2 * voxelize::kWeldGap * layer.halfHeight();
            addRun(runOf(layer.bottom() - gap, layer.top() + gap), layer.first, layer.last);
        }
        for (std::uint32_t rank = stack.first_direct; rank < stack.beads.size(); ++rank) {
            const voxelize::Extent& extent = stack.extentOf(rank);
            addRun(runOf(extent.z_min, extent.z_max), rank, rank + 1);
        }
    }

    void mapSlab(std::size_t slab) {
        const auto columns_i = static_cast<std::size_t>(map_.macros[0]);
        const auto columns_j = static_cast<std::size_t>(map_.macros[1]);
        // Separate from the map, where words of other threads' slabs are adjacent.
        std::vector<std::uint64_t> words(columns_i * columns_j);
        std::vector<std::uint32_t> firsts(words.size(), std::numeric_limits<std::uint32_t>::max());
        for (const Part& part : slabs_[slab]) {
            const int base = static_cast<int>(slab) * kBricks;
            std::uint64_t z = 0;
            for (int k = std::max(part.run.first - base, 0); k <= std::min(part.run.second - base, kBricks - 1); ++k)
                z |= std::uint64_t{1} << k;
            for (std::uint32_t rank = part.first; rank != part.last; ++rank) {
                const std::uint32_t index = layout_.stack.beads[rank];
                const gcode::Bead& bead = layout_.toolpath->beads[index];
                footprints_.forEachColumn(bead, [&](int i0, int i1, int j) {
                    const int y = j - first_j_;
                    if (y < low_[1] || y > high_[1]) return;
                    const std::uint64_t row = z << ((y & 3) << 2);
                    const int x1 = std::min(i1 - first_i_, high_[0]);
                    for (int x = std::max(i0 - first_i_, low_[0]); x <= x1; ++x) {
                        const std::size_t word =
                            static_cast<std::size_t>(x >> 2) * columns_j + static_cast<std::size_t>(y >> 2);
                        words[word] |= row << ((x & 3) << 4);
                        firsts[word] = std::min(firsts[word], index);
                    }
                });
            }
        }
        const auto slabs = static_cast<std::size_t>(map_.macros[2]);
        for (std::size_t n = 0; n < words.size(); ++n) {
            map_.masks[n * slabs + slab] = words[n];
            first_bead_[n * slabs + slab] = firsts[n];
        }
    }

private:
    struct Part {
        Run run;
        std::uint32_t first, last;  // ranks
    };

    // The bricks that a solid from z_min to z_max (mm) has samples of.
    Run runOf(double z_min, double z_max) const {
        const double edge = kBrick * layout_.lattice.voxel_size;
        const double origin = layout_.lattice.origin_z + map_.origin[2] * layout_.lattice.voxel_size;
        const double slack = kSlack / kBrick;
        return {std::max(static_cast<int>(std::ceil((z_min - origin) / edge - 1 - slack)), low_[2]),
                std::min(static_cast<int>(std::floor((z_max - origin) / edge + slack)), high_[2])};
    }

    void addRun(const Run& run, std::uint32_t first, std::uint32_t last) {
        if (run.first > run.second) return;
        for (int slab = run.first / kBricks; slab <= run.second / kBricks; ++slab) {
            std::vector<Part>& parts = slabs_[static_cast<std::size_t>(slab)];
            parts.push_back({run, first, last});
        }
    }

    const PrintLayout& layout_;
    march::BrickMap& map_;
    std::vector<std::uint32_t>& first_bead_;
    openvdb::Coord low_, high_;  // bricks with active voxels, from the map's origin
    const voxelize::Footprints footprints_;
    int first_i_ = 0, first_j_ = 0;
    std::vector<std::vector<Part>> slabs_;
};

}  // namespace

PrintMap mapBricks(const PrintLayout& layout, const openvdb::CoordBBox& active) {
    PrintMap result;
    march::BrickMap& map = result.bricks;
    map.origin = active.min() & ~(kMacro - 1);
    double macros = 1;
    for (int axis = 0; axis < 3; ++axis) {
        const int count = (active.max()[axis] - map.origin[axis]) / kMacro + 1;
        map.macros[static_cast<std::size_t>(axis)] = count;
        macros *= count;
    }
    // Bricks are in the columns that beads reach; the table is made before they are counted.
    const auto heights = static_cast<std::size_t>((active.max()[2] - map.origin[2]) / kBrick) + 1;
    if (!march::BrickGrid::canSpan(map.macros, layout.columns.size() * heights))
        throw UsageError(
            fmt::format("voxels of {:g} mm make {:.3g} blocks of 32 x 32 x 32, too many for the beads in them to be "
                        "laid out for rays; choose a larger voxel, or print parts that lie far apart one by one",
                        layout.lattice.voxel_size, macros));
    map.masks.resize(static_cast<std::size_t>(macros));
    result.first_bead.resize(map.masks.size());
    Mapper mapper(layout, active, result);
    mapper.listSlabs();
    parallelFor(static_cast<std::size_t>(map.macros[2]), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t slab = first; slab != last; ++slab) mapper.mapSlab(slab);
    });
    return result;
}

}  // namespace stratum::ondemand
