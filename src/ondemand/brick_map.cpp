#include "ondemand/brick_map.h"

#include "base/error.h"
#include "base/parallel_for.h"
#include "march/brick/brick_grid.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/beads/footprint.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace stratum::ondemand {
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
