// LayerStack + Lattice -> the print as columns of leaves: the beads of each column, and a LeafColumn for each thread.
#pragma once

#include "base/parallel_for.h"
#include "base/progress_meter.h"
#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/lattice.h"
#include "voxelize/beads/layer_stack.h"
#include "voxelize/beads/plan_bins.h"
#include "voxelize/leaf/leaf_column.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>

namespace stratum::voxelize {

/// What everybody samples a print by: grids, streams, attributes, balances, contacts, elements, bricks. All threads may
/// call all methods; what a LeafColumn holds belongs to the calling thread until it opens the next column.
class PrintColumns {
public:
    static constexpr std::uint32_t kAllBeads = std::numeric_limits<std::uint32_t>::max();
    static constexpr std::size_t kNone = PlanBins::kNone;

    /// `toolpath`, `stack` and `lattice` must outlive the object. `scale`: world units a mm. Parallel. Throws
    /// UsageError if the lists of beads need more than a quarter of `free_memory` bytes.
    PrintColumns(const gcode::Toolpath& toolpath, const LayerStack& stack, const Lattice& lattice, double scale = 1,
                 LeafColumn::Kind kind = LeafColumn::Kind::values,
                 std::size_t free_memory = std::numeric_limits<std::size_t>::max());

    const gcode::Toolpath& toolpath() const { return toolpath_; }
    const LayerStack& stack() const { return stack_; }
    const Lattice& lattice() const { return lattice_; }
    const PlanBins& bins() const { return bins_; }
    std::size_t size() const { return bins_.size(); }

    /// Opens a column for the beads with an index in the toolpath below `end`.
    LeafColumn& open(std::size_t c, std::uint32_t end = kAllBeads) const {
        LeafColumn& column = threads_.local();
        column.open(bins_.originI(c), bins_.originJ(c), bins_[c], end);
        return column;
    }
    /// The LeafColumn of the calling thread, with a leaf of that column evaluated. It is opened only if it is not, or
    /// is beyond that leaf.
    LeafColumn& evaluate(std::size_t c, int leaf_k, std::uint32_t end, LeafContent& content) const {
        LeafColumn& column = threads_.local();
        if (!column.mayEvaluate(bins_.originI(c), bins_.originJ(c), end, leaf_k)) open(c, end);
        content = column.evaluate(leaf_k);
        return column;
    }
    /// LeafColumn::bounds() of a column.
    std::span<const LeafRange> bounds(std::size_t c) const { return threads_.local().bounds(bins_[c]); }

    /// Calls visit(c, column) for each column, which is open for the beads below `end`; in parallel.
    template <typename Visit>
    void forEach(std::uint32_t end, const Visit& visit, const std::function<void(double)>& progress = {}) const {
        constexpr std::size_t kGrain = 16;
        ProgressMeter meter(std::max<std::size_t>(bins_.entryCount(), 1), progress);
        parallelFor(size(), kGrain, [&](std::size_t first, std::size_t last) {
            for (std::size_t c = first; c != last; ++c) {
                visit(c, open(c, end));
                meter.advance(bins_[c].size());
            }
        });
    }

private:
    const gcode::Toolpath& toolpath_;
    const LayerStack& stack_;
    const Lattice& lattice_;
    const double scale_;
    const PlanBins bins_;
    mutable PerThread<LeafColumn> threads_;
};

}  // namespace stratum::voxelize
