#include "voxelize/plan_bins.h"

#include "io/error.h"
#include "voxelize/bead_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace stratum::voxelize {
namespace {

// Rectangle of columns [first, last] that a bead's band can reach.
struct ColumnRange {
    int i0, i1, j0, j1;
};

// A bead as binning sees it: its path from above and how far its band reaches from it.
struct Footprint {
    PlanPath path;
    double reach;  // mm
    ColumnRange columns;
};

Footprint footprintOf(const gcode::Toolpath& toolpath, std::uint32_t index, const Lattice& lattice) {
    const BeadField field(toolpath, toolpath.beads[index]);
    const double reach = field.halfFlat() + field.radius() + lattice.background();
    double min[2];
    double max[2];
    field.path().bounds(min, max);
    const double edge = lattice.voxel_size * kLeafDim;
    // Samples of column c lie at voxels 8c .. 8c+7, so floor of the voxel index over 8 is the column.
    const auto column = [edge](double mm) { return static_cast<int>(std::floor(mm / edge)); };
    return {field.path(),
            reach,
            {column(min[0] - reach), column(max[0] + reach), column(min[1] - reach), column(max[1] + reach)}};
}

template <typename Visit>
void forEachColumn(const Footprint& footprint, const Lattice& lattice, Visit visit) {
    // The samples of a column span 7 voxels: no sample is farther from their centre than half the diagonal of that.
    const double half = 0.5 * (kLeafDim - 1) * lattice.voxel_size;
    const double limit = footprint.reach + half * std::sqrt(2.0);
    const double edge = lattice.voxel_size * kLeafDim;
    for (int j = footprint.columns.j0; j <= footprint.columns.j1; ++j)
        for (int i = footprint.columns.i0; i <= footprint.columns.i1; ++i)
            if (footprint.path.distance(i * edge + half, j * edge + half) <= limit) visit(i, j);
}

}  // namespace

PlanBins::PlanBins(const gcode::Toolpath& toolpath, const LayerStack& stack, const Lattice& lattice,
                   std::size_t memory_limit) {
    // Visits (layer, bead) in the order the entries must have within a column.
    const auto forEachBead = [&stack](auto visit) {
        for (std::uint32_t layer = 0; layer < stack.layers.size(); ++layer)
            for (const std::uint32_t bead : stack.layers[layer].beads) visit(layer, bead);
        for (const std::uint32_t bead : stack.direct) visit(static_cast<std::uint32_t>(stack.layers.size()), bead);
    };

    // Bound the work by arithmetic alone before anything is visited or allocated.
    double bound = 0;
    ColumnRange all{std::numeric_limits<int>::max(), std::numeric_limits<int>::min(), std::numeric_limits<int>::max(),
                    std::numeric_limits<int>::min()};
    const double edge = lattice.voxel_size * kLeafDim;
    forEachBead([&](std::uint32_t, std::uint32_t bead) {
        const Footprint footprint = footprintOf(toolpath, bead, lattice);
        const double across = 2 * footprint.reach / edge + 2;
        bound += (footprint.path.length() / edge + across) * across;
        all.i0 = std::min(all.i0, footprint.columns.i0);
        all.i1 = std::max(all.i1, footprint.columns.i1);
        all.j0 = std::min(all.j0, footprint.columns.j0);
        all.j1 = std::max(all.j1, footprint.columns.j1);
    });
    if (bound == 0) return;
    first_i_ = all.i0;
    first_j_ = all.j0;
    const double columns = (static_cast<double>(all.i1) - all.i0 + 1) * (static_cast<double>(all.j1) - all.j0 + 1);
    const double bytes = columns * sizeof(std::size_t) + bound * sizeof(BinEntry);
    if (bytes > static_cast<double>(memory_limit))
        throw UsageError(
            fmt::format("voxel size {:g} mm needs about {:.3g} GB for its lists alone ({:.3g} GB are free); "
                        "choose a larger voxel",
                        lattice.voxel_size, bytes * 1e-9, static_cast<double>(memory_limit) * 1e-9));
    columns_i_ = static_cast<std::size_t>(all.i1 - all.i0) + 1;
    columns_j_ = static_cast<std::size_t>(all.j1 - all.j0) + 1;

    const auto columnIndex = [this](int i, int j) {
        return static_cast<std::size_t>(j - first_j_) * columns_i_ + static_cast<std::size_t>(i - first_i_);
    };
    offsets_.assign(columns_i_ * columns_j_ + 1, 0);
    forEachBead([&](std::uint32_t, std::uint32_t bead) {
        forEachColumn(footprintOf(toolpath, bead, lattice), lattice,
                      [&](int i, int j) { ++offsets_[columnIndex(i, j) + 1]; });
    });
    for (std::size_t c = 1; c < offsets_.size(); ++c) offsets_[c] += offsets_[c - 1];
    entries_.resize(offsets_.back());
    std::vector<std::size_t> next(offsets_.begin(), offsets_.end() - 1);
    forEachBead([&](std::uint32_t layer, std::uint32_t bead) {
        forEachColumn(footprintOf(toolpath, bead, lattice), lattice, [&](int i, int j) {
            entries_[next[columnIndex(i, j)]++] = {layer, bead};
        });
    });
}

}  // namespace stratum::voxelize
