#include "voxelize/grid/leaf_share.h"

#include "base/parallel_for.h"
#include "voxelize/grid/leaf_blocks.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace stratum::voxelize {
namespace {

constexpr std::size_t kBeadsAPart = 32768;

/// Bounds of the entries in the bins, by tile of the plan and by upper node along z.
class BlockWeights {
public:
    BlockWeights(const ColumnRange& columns, const LeafRange& heights)
        : first_x_(PlanTiles::tileOf(columns.i0)),
          first_y_(PlanTiles::tileOf(columns.j0)),
          first_slab_(floorDivide(heights.first, kSlabLeaves)),
          last_x_(PlanTiles::tileOf(columns.i1)),
          last_y_(PlanTiles::tileOf(columns.j1)),
          last_slab_(floorDivide(heights.second, kSlabLeaves)),
          count_y_(static_cast<std::size_t>(last_y_ - first_y_) + 1),
          slabs_(static_cast<std::size_t>(last_slab_ - first_slab_) + 1),
          weights_((static_cast<std::size_t>(last_x_ - first_x_) + 1) * count_y_ * slabs_) {}

    std::uint64_t at(int x, int y, int slab) const { return weights_[placeOf(x, y, slab)]; }
    /// Places outside count as the nearest block.
    void add(double x, double y, int slab, std::uint64_t weight) {
        weights_[placeOf(clampTo(x, first_x_, last_x_), clampTo(y, first_y_, last_y_),
                         std::clamp(slab, first_slab_, last_slab_))] += weight;
    }
    void add(const BlockWeights& other) {
        for (std::size_t n = 0; n < weights_.size(); ++n) weights_[n] += other.weights_[n];
    }

private:
    static int clampTo(double tile, int first, int last) {
        return static_cast<int>(std::clamp(std::floor(tile), static_cast<double>(first), static_cast<double>(last)));
    }
    std::size_t placeOf(int x, int y, int slab) const {
        const auto from = [](int at, int first) { return static_cast<std::size_t>(at - first); };
        return (from(x, first_x_) * count_y_ + from(y, first_y_)) * slabs_ + from(slab, first_slab_);
    }

    int first_x_, first_y_, first_slab_, last_x_, last_y_, last_slab_;
    std::size_t count_y_, slabs_;
    std::vector<std::uint64_t> weights_;
};

// Whole numbers, so that it does not matter how they are summed. A long bead counts in pieces, each where its middle
// is.
void addBead(const gcode::Toolpath& toolpath, const Footprints& footprints, const Lattice& lattice,
             const gcode::Bead& bead, BlockWeights& weights) {
    const double tile = lattice.voxel_size * kBlockVoxels;
    const double entries = mostColumns(toolpath, bead, footprints.limit(bead), lattice);
    const double dx = bead.x1 - bead.x0;
    const double dy = bead.y1 - bead.y0;
    const gcode::Arc* arc = bead.arc >= 0 ? &toolpath.arcs[static_cast<std::size_t>(bead.arc)] : nullptr;
    const double length = arc != nullptr ? PlanPath(toolpath, bead).length() : std::max(std::abs(dx), std::abs(dy));
    constexpr double kMostPieces = 1e4;
    const double pieces = std::clamp(std::ceil(2 * length / tile), 1.0, kMostPieces);
    const auto weight = static_cast<std::uint64_t>(std::min(entries / pieces, 1e12));
    // In all slabs that the bead reaches, e.g. the one below the bed: each has leaves of it.
    const LeafRange leaves = leavesAround(lattice, std::min<double>(bead.z0, bead.z1) - toolpath.runOf(bead).height,
                                          std::max<double>(bead.z0, bead.z1));
    const int first_slab = floorDivide(leaves.first, kSlabLeaves);
    const int last_slab = floorDivide(leaves.second, kSlabLeaves);
    for (int n = 0; n < static_cast<int>(pieces); ++n) {
        const double middle = (n + 0.5) / pieces;
        double x = bead.x0 + middle * dx;
        double y = bead.y0 + middle * dy;
        if (arc != nullptr) {
            const double cosine = std::cos(middle * arc->sweep);
            const double sine = std::sin(middle * arc->sweep);
            const double from_x = bead.x0 - arc->center_x;
            const double from_y = bead.y0 - arc->center_y;
            x = arc->center_x + cosine * from_x - sine * from_y;
            y = arc->center_y + sine * from_x + cosine * from_y;
        }
        for (int slab = first_slab; slab <= last_slab; ++slab) weights.add(x / tile, y / tile, slab, weight);
    }
}

ColumnRange columnsOf(const gcode::Toolpath& toolpath, const LayerStack& stack, const Footprints& footprints) {
    const std::size_t parts = stack.beads.size() / kBeadsAPart + 1;
    std::vector<ColumnRange> ranges(parts);
    parallelFor(parts, 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t p = first; p != last; ++p)
            for (std::size_t rank = stack.beads.size() * p / parts; rank != stack.beads.size() * (p + 1) / parts;
                 ++rank) {
                const gcode::Bead& bead = toolpath.beads[stack.beads[rank]];
                ranges[p].include(footprints.range(bead, footprints.limit(bead)));
            }
    });
    ColumnRange all;
    for (const ColumnRange& range : ranges) all.include(range);
    return all;
}

BlockWeights weigh(const gcode::Toolpath& toolpath, const LayerStack& stack, const Lattice& lattice,
                   const Footprints& footprints, const ColumnRange& columns, const LeafRange& heights) {
    const std::size_t parts = std::min<std::size_t>(stack.beads.size() / kBeadsAPart + 1, 16);
    std::vector<BlockWeights> weights(parts, BlockWeights(columns, heights));
    parallelFor(parts, 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t p = first; p != last; ++p)
            for (std::size_t rank = stack.beads.size() * p / parts; rank != stack.beads.size() * (p + 1) / parts;
                 ++rank)
                addBead(toolpath, footprints, lattice, toolpath.beads[stack.beads[rank]], weights[p]);
    });
    for (std::size_t p = 1; p < parts; ++p) weights.front().add(weights[p]);
    return std::move(weights.front());
}

// Of its samples, and a voxel more against rounding.
HeightRange heightsOf(const LeafBlock& block, const Lattice& lattice) {
    const auto height = [&](double k) { return lattice.origin_z + k * lattice.voxel_size; };
    return {height(block.heights.first * double{kLeafDim} - 1), height((block.heights.second + 1) * double{kLeafDim})};
}

}  // namespace

LeafShare shareOf(const gcode::Toolpath& toolpath, const LayerStack& stack, const Lattice& lattice,
                  const Shard& shard) {
    const Footprints footprints = columnFootprints(toolpath, lattice);
    const ColumnRange columns = columnsOf(toolpath, stack, footprints);
    const LeafRange heights = leavesAround(lattice, stack);
    const BlockWeights weights = weigh(toolpath, stack, lattice, footprints, columns, heights);
    const LeafRectangle plan{columns.i0, columns.i1, columns.j0, columns.j1};
    const auto weightOf = [&](const LeafBlock& block) {
        return weights.at(block.x, block.y, floorDivide(block.heights.first, kSlabLeaves));
    };
    std::uint64_t all = 0;
    forEachBlock(plan, heights, [&](std::size_t, const LeafBlock& block) { all += weightOf(block); });
    const auto index = static_cast<std::size_t>(shard.index);
    LeafShare share{{0, 0}, PlanTiles(columns)};
    std::uint64_t before = 0;
    forEachBlock(plan, heights, [&](std::size_t number, const LeafBlock& block) {
        const std::uint64_t weight = weightOf(block);
        // A block is of the shard in whose part of the weight its middle lies.
        const double middle = static_cast<double>(before) + 0.5 * static_cast<double>(weight);
        const auto owner = std::min<std::size_t>(
            static_cast<std::size_t>(middle / static_cast<double>(std::max<std::uint64_t>(all, 1)) * shard.count),
            static_cast<std::size_t>(shard.count) - 1);
        before += weight;
        if (owner < index) share.blocks.first = number + 1;
        if (owner <= index) share.blocks.end = number + 1;
        if (owner == index) share.tiles.choose(block.x, block.y, heightsOf(block, lattice));
    });
    return share;
}

}  // namespace stratum::voxelize
