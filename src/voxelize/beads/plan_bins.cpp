#include "voxelize/beads/plan_bins.h"

#include "base/error.h"
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

// An upper bound on the entries by arithmetic, before anything is visited or allocated, and the rectangle of columns.
std::pair<double, ColumnRange> boundEntries(const gcode::Toolpath& toolpath, const LayerStack& stack,
                                            const Footprints& footprints, double edge, std::size_t parts) {
    const std::size_t beads = stack.beads.size();
    std::vector<double> part_bounds(parts, 0.0);
    std::vector<ColumnRange> part_ranges(parts);
    parallelFor(parts, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p != end; ++p)
            for (std::size_t rank = beads * p / parts; rank != beads * (p + 1) / parts; ++rank) {
                const gcode::Bead& bead = toolpath.beads[stack.beads[rank]];
                const double limit = footprints.limit(bead);
                const double across = 2 * limit / edge + 1;
                const double dx = bead.x1 - bead.x0;
                const double dy = bead.y1 - bead.y0;
                double length = std::sqrt(dx * dx + dy * dy);
                if (bead.arc >= 0) length = PlanPath(toolpath, bead).length();
                part_bounds[p] += (length / edge + across) * across;
                part_ranges[p].include(footprints.range(bead, limit));
            }
    });
    double bound = 0;
    ColumnRange all;
    for (std::size_t p = 0; p < parts; ++p) {
        bound += part_bounds[p];
        all.include(part_ranges[p]);
    }
    return {bound, all};
}

}  // namespace

PlanBins::PlanBins(const gcode::Toolpath& toolpath, const LayerStack& stack, const Lattice& lattice,
                   std::size_t memory_limit) {
    if (stack.beads.empty()) return;
    const double edge = lattice.voxel_size * kLeafDim;
    const Footprints footprints(toolpath, edge, 0.5 * (kLeafDim - 1) * lattice.voxel_size, lattice.background(),
                                Footprints::Reach::field);
    const auto beadAt = [&](std::size_t rank) -> const gcode::Bead& { return toolpath.beads[stack.beads[rank]]; };
    const std::size_t beads = stack.beads.size();
    std::size_t parts = std::clamp<std::size_t>(beads / kFewestBeadsAPart, 1, kMostParts);

    const auto [bound, all] = boundEntries(toolpath, stack, footprints, edge, parts);
    if (all.empty()) return;
    first_i_ = all.i0;
    first_j_ = all.j0;
    const double columns = (static_cast<double>(all.i1) - all.i0 + 1) * (static_cast<double>(all.j1) - all.j0 + 1);
    // Without a table for each part if the bed is wide and mostly empty.
    while (parts > 1 && columns * static_cast<double>(parts) > 2 * bound + 1e6) parts /= 2;
    const double bytes = columns * static_cast<double>(sizeof(std::size_t) + parts * sizeof(std::uint32_t)) +
                         bound * sizeof(std::uint32_t);
    if (bytes > static_cast<double>(memory_limit))
        throw UsageError(
            fmt::format("voxel size {:g} mm needs about {:.3g} GB for its lists alone ({:.3g} GB are free); "
                        "choose a larger voxel, or let --memory-budget choose one",
                        lattice.voxel_size, bytes * 1e-9, static_cast<double>(memory_limit) * 1e-9));
    columns_i_ = static_cast<std::size_t>(all.i1 - all.i0) + 1;
    columns_j_ = static_cast<std::size_t>(all.j1 - all.j0) + 1;
    const std::size_t count = columns_i_ * columns_j_;
    const auto columnIndex = [this](int i, int j) {
        return static_cast<std::size_t>(j - first_j_) * columns_i_ + static_cast<std::size_t>(i - first_i_);
    };

    // Counts by part and column; then, by column, where each part's ranks begin, relative to the column.
    std::vector<std::uint32_t> next(parts * count, 0);
    parallelFor(parts, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p != end; ++p) {
            std::uint32_t* counts = next.data() + p * count;
            for (std::size_t rank = beads * p / parts; rank != beads * (p + 1) / parts; ++rank)
                footprints.forEachColumn(beadAt(rank), [&](int i0, int i1, int j) {
                    for (std::size_t c = columnIndex(i0, j); i0 <= i1; ++i0, ++c) ++counts[c];
                });
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
            for (std::size_t rank = beads * p / parts; rank != beads * (p + 1) / parts; ++rank)
                footprints.forEachColumn(beadAt(rank), [&](int i0, int i1, int j) {
                    for (std::size_t c = columnIndex(i0, j); i0 <= i1; ++i0, ++c)
                        ranks_[offsets_[c] + next_entry[c]++] = static_cast<std::uint32_t>(rank);
                });
        }
    });
}

}  // namespace stratum::voxelize
