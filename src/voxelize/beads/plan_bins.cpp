#include "voxelize/beads/plan_bins.h"

#include "base/error.h"
#include "base/human_text.h"
#include "base/parallel_for.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/beads/footprint.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace stratum::voxelize {
namespace {

// Beads in parts of equal number. A part counts and later fills its own entries, so the ranks of a column ascend for
// any number of parts.
constexpr std::size_t kMostParts = 16;
constexpr std::size_t kFewestBeadsAPart = 4096;
// The lists take at most one part in so many of the free memory; what is made with their help needs the rest.
constexpr double kListsOfMemory = 4;

// Ranks in parts of equal number, and what is known of the entries before anything is allocated: an upper bound by
// arithmetic, and the rectangle of columns.
struct Parts {
    std::size_t count = 1;
    double bound = 0;
    ColumnRange columns;
};

// At most so many entries of bins has a bead that reaches this far: see Footprints::limit().
double mostColumns(const gcode::Toolpath& toolpath, const gcode::Bead& bead, double limit, const Lattice& lattice) {
    const double edge = lattice.voxel_size * kLeafDim;
    const double across = 2 * limit / edge + 1;
    const double dx = bead.x1 - bead.x0;
    const double dy = bead.y1 - bead.y0;
    double length = std::sqrt(dx * dx + dy * dy);
    if (bead.arc >= 0) length = PlanPath(toolpath, bead).length();
    return (length / edge + across) * across;
}

Parts boundEntries(const gcode::Toolpath& toolpath, const LayerStack& stack, const Lattice& lattice,
                   const Footprints& footprints) {
    const std::size_t beads = stack.beads.size();
    Parts parts;
    parts.count = std::clamp<std::size_t>(beads / kFewestBeadsAPart, 1, kMostParts);
    std::vector<double> bounds(parts.count, 0.0);
    std::vector<ColumnRange> ranges(parts.count);
    parallelFor(parts.count, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p != end; ++p)
            for (std::size_t rank = beads * p / parts.count; rank != beads * (p + 1) / parts.count; ++rank) {
                const gcode::Bead& bead = toolpath.beads[stack.beads[rank]];
                const double limit = footprints.limit(bead);
                bounds[p] += mostColumns(toolpath, bead, limit, lattice);
                ranges[p].include(footprints.range(bead, limit));
            }
    });
    for (std::size_t p = 0; p < parts.count; ++p) {
        parts.bound += bounds[p];
        parts.columns.include(ranges[p]);
    }
    return parts;
}

}  // namespace

PlanBins::PlanBins(const gcode::Toolpath& toolpath, const LayerStack& stack, const Lattice& lattice,
                   std::size_t free_memory) {
    if (stack.beads.empty()) return;
    const Footprints footprints = columnFootprints(toolpath, lattice);
    const std::size_t beads = stack.beads.size();
    const Parts found = boundEntries(toolpath, stack, lattice, footprints);
    const ColumnRange& all = found.columns;
    const double bound = found.bound;
    std::size_t parts = found.count;
    if (all.empty()) return;
    first_i_ = all.i0;
    first_j_ = all.j0;
    const double columns = (static_cast<double>(all.i1) - all.i0 + 1) * (static_cast<double>(all.j1) - all.j0 + 1);
    // Without a table for each part if the bed is wide and mostly empty.
    while (parts > 1 && columns * static_cast<double>(parts) > 2 * bound + 1e6) parts /= 2;
    const double bytes = columns * static_cast<double>(sizeof(std::size_t) + parts * sizeof(std::uint32_t)) +
                         bound * sizeof(std::uint32_t);
    const double limit = static_cast<double>(free_memory) / kListsOfMemory;
    if (bytes > limit)
        // Of half the voxel they are four times as many at most.
        throw UsageError(fmt::format(
            "the lists of the beads near each voxel take about {}, which is more than a quarter of the {} that are "
            "free; "
            "choose voxels about {:.2g} times as large (--voxel-size), or fewer layers (--layers)",
            humanBytes(bytes), humanBytes(static_cast<double>(free_memory)), 1.05 * std::sqrt(bytes / limit)));
    columns_i_ = static_cast<std::size_t>(all.i1 - all.i0) + 1;
    columns_j_ = static_cast<std::size_t>(all.j1 - all.j0) + 1;
    const std::size_t count = columns_i_ * columns_j_;
    const auto columnIndex = [this](int i, int j) {
        return static_cast<std::size_t>(j - first_j_) * columns_i_ + static_cast<std::size_t>(i - first_i_);
    };

    // Calls visit(rank, column) for the entries of a part, by rank.
    const auto forEachEntry = [&](std::size_t p, const auto& visit) {
        for (std::size_t rank = beads * p / parts; rank != beads * (p + 1) / parts; ++rank)
            footprints.forEachColumn(toolpath.beads[stack.beads[rank]], [&](int i0, int i1, int j) {
                for (std::size_t c = columnIndex(i0, j); i0 <= i1; ++i0, ++c) visit(rank, c);
            });
    };

    // Counts by part and column; then, by column, where each part's ranks begin, relative to the column.
    std::vector<std::uint32_t> next(parts * count, 0);
    parallelFor(parts, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p != end; ++p) {
            std::uint32_t* counts = next.data() + p * count;
            forEachEntry(p, [counts](std::size_t, std::size_t c) { ++counts[c]; });
        }
    });
    offsets_.assign(count + 1, 0);
    for (std::size_t c = 0; c < count; ++c) {
        std::uint32_t sum = 0;
        for (std::size_t p = 0; p < parts; ++p) {
            const std::uint32_t own = next[p * count + c];
            next[p * count + c] = sum;
            sum += own;
        }
        offsets_[c + 1] = offsets_[c] + sum;
    }
    ranks_ = HugeArray<std::uint32_t>(offsets_.back());
    parallelFor(parts, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p != end; ++p) {
            std::uint32_t* next_entry = next.data() + p * count;
            forEachEntry(p, [&](std::size_t rank, std::size_t c) {
                ranks_[offsets_[c] + next_entry[c]++] = static_cast<std::uint32_t>(rank);
            });
        }
    });
}

}  // namespace stratum::voxelize
