#include "voxelize/plan_bins.h"

#include "io/error.h"
#include "parallel/parallel_for.h"
#include "voxelize/bead_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace stratum::voxelize {
namespace {

// Rectangle of columns [first, last].
struct ColumnRange {
    int i0 = std::numeric_limits<int>::max();
    int i1 = std::numeric_limits<int>::min();
    int j0 = std::numeric_limits<int>::max();
    int j1 = std::numeric_limits<int>::min();

    bool empty() const { return i0 > i1; }
    void include(const ColumnRange& other) {
        i0 = std::min(i0, other.i0);
        i1 = std::max(i1, other.i1);
        j0 = std::min(j0, other.j0);
        j1 = std::max(j1, other.j1);
    }
};

// Visits the columns that beads reach. A column is reached if the centre of its samples is within `limit` of the path:
// no sample is farther from that centre than half the diagonal they span, seven voxels.
class Footprints {
public:
    Footprints(const gcode::Toolpath& toolpath, const Lattice& lattice)
        : toolpath_(toolpath),
          edge_(lattice.voxel_size * kLeafDim),
          half_(0.5 * (kLeafDim - 1) * lattice.voxel_size),
          // The part in 1e9 keeps rounding on the safe side.
          slack_((lattice.background() + half_ * std::sqrt(2.0)) * (1 + 1e-9)) {}

    double limit(const gcode::Bead& bead) const {
        const Section section = sectionOf(toolpath_, bead);
        return section.half_flat + radiusOf(bead, section) + slack_;
    }

    // Columns whose centres lie in the box of the path, `limit` wider all around; mm over edge.
    ColumnRange range(const gcode::Bead& bead, double limit) const {
        double min[2] = {std::min(bead.x0, bead.x1), std::min(bead.y0, bead.y1)};
        double max[2] = {std::max(bead.x0, bead.x1), std::max(bead.y0, bead.y1)};
        if (bead.arc >= 0) PlanPath(toolpath_, bead).bounds(min, max);
        return {first(min[0] - limit), last(max[0] + limit), first(min[1] - limit), last(max[1] + limit)};
    }

    template <typename Visit>
    void forEachColumn(const gcode::Bead& bead, Visit visit) const {
        const double reach = limit(bead);
        const ColumnRange columns = range(bead, reach);
        if (bead.arc >= 0) {
            const PlanPath path(toolpath_, bead);
            for (int j = columns.j0; j <= columns.j1; ++j)
                for (int i = columns.i0; i <= columns.i1; ++i)
                    if (path.distance(i * edge_ + half_, j * edge_ + half_) <= reach) visit(i, i, j);
            return;
        }
        // A straight bead's reach is a capsule: convex, so one run of columns a row. The run spans what the row cuts
        // from the discs about the ends and from the two long sides.
        const double dx = bead.x1 - bead.x0;
        const double dy = bead.y1 - bead.y0;
        const double length = std::sqrt(dx * dx + dy * dy);
        const double side_x = length > 0 ? -dy / length * reach : 0;
        const double side_y = length > 0 ? dx / length * reach : 0;
        for (int j = columns.j0; j <= columns.j1; ++j) {
            const double y = j * edge_ + half_;
            double low = std::numeric_limits<double>::max();
            double high = -std::numeric_limits<double>::max();
            const auto include = [&](double x) {
                low = std::min(low, x);
                high = std::max(high, x);
            };
            const auto disc = [&](double x0, double y0) {
                const double h2 = reach * reach - (y - y0) * (y - y0);
                if (h2 < 0) return;
                const double h = std::sqrt(h2);
                include(x0 - h);
                include(x0 + h);
            };
            disc(bead.x0, bead.y0);
            disc(bead.x1, bead.y1);
            for (const double turn : {-1.0, 1.0}) {
                const double up = y - (bead.y0 + turn * side_y);
                // 0 <= up / dy <= 1, written so that a level path divides nothing.
                if (dy != 0 && up * dy >= 0 && std::abs(up) <= std::abs(dy))
                    include(bead.x0 + turn * side_x + up / dy * dx);
            }
            if (low > high) continue;
            const int i0 = std::max(first(low), columns.i0);
            const int i1 = std::min(last(high), columns.i1);
            if (i0 <= i1) visit(i0, i1, j);
        }
    }

private:
    // A bead too steep for flats is a rod of the same area; see BeadField.
    double radiusOf(const gcode::Bead& bead, const Section& section) const {
        return bead.z0 == bead.z1 ? section.radius : BeadField(toolpath_, bead).radius();
    }
    int first(double mm) const { return static_cast<int>(std::ceil((mm - half_) / edge_ - 1e-9)); }
    int last(double mm) const { return static_cast<int>(std::floor((mm - half_) / edge_ + 1e-9)); }

    const gcode::Toolpath& toolpath_;
    const double edge_, half_, slack_;  // mm
};

// Beads in parts of equal number. A part counts and later fills its own places, so the ranks of a column ascend for any
// number of parts.
constexpr std::size_t kMostParts = 16;
constexpr std::size_t kFewestBeadsAPart = 4096;

}  // namespace

PlanBins::PlanBins(const gcode::Toolpath& toolpath, const LayerStack& stack, const Lattice& lattice,
                   std::size_t memory_limit) {
    if (stack.beads.empty()) return;
    const Footprints footprints(toolpath, lattice);
    const auto beadAt = [&](std::size_t rank) -> const gcode::Bead& { return toolpath.beads[stack.beads[rank]]; };
    const std::size_t beads = stack.beads.size();
    std::size_t parts = std::clamp<std::size_t>(beads / kFewestBeadsAPart, 1, kMostParts);

    // Bound the work by arithmetic alone before anything is visited or allocated.
    const double edge = lattice.voxel_size * kLeafDim;
    std::vector<double> part_bounds(parts, 0.0);
    std::vector<ColumnRange> part_ranges(parts);
    parallelFor(parts, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p != end; ++p)
            for (std::size_t rank = beads * p / parts; rank != beads * (p + 1) / parts; ++rank) {
                const gcode::Bead& bead = beadAt(rank);
                const double limit = footprints.limit(bead);
                const double across = 2 * limit / edge + 1;
                double length = std::hypot(bead.x1 - bead.x0, bead.y1 - bead.y0);
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
    if (all.empty()) return;
    first_i_ = all.i0;
    first_j_ = all.j0;
    const double columns = (static_cast<double>(all.i1) - all.i0 + 1) * (static_cast<double>(all.j1) - all.j0 + 1);
    // A wide, empty bed must not cost a table a part.
    while (parts > 1 && columns * static_cast<double>(parts) > 2 * bound + 1e6) parts /= 2;
    const double bytes = columns * static_cast<double>(sizeof(std::size_t) + parts * sizeof(std::uint32_t)) +
                         bound * sizeof(std::uint32_t);
    if (bytes > static_cast<double>(memory_limit))
        throw UsageError(
            fmt::format("voxel size {:g} mm needs about {:.3g} GB for its lists alone ({:.3g} GB are free); "
                        "choose a larger voxel",
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
    ranks_.resize(offsets_.back());
    parallelFor(parts, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p != end; ++p) {
            std::uint32_t* places = next.data() + p * count;
            for (std::size_t rank = beads * p / parts; rank != beads * (p + 1) / parts; ++rank)
                footprints.forEachColumn(beadAt(rank), [&](int i0, int i1, int j) {
                    for (std::size_t c = columnIndex(i0, j); i0 <= i1; ++i0, ++c)
                        ranks_[offsets_[c] + places[c]++] = static_cast<std::uint32_t>(rank);
                });
        }
    });
}

}  // namespace stratum::voxelize
