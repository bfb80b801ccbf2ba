// Toolpath -> the data to sample the print anywhere, and the evaluation of single leaves.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/lattice.h"
#include "voxelize/beads/layer_stack.h"
#include "voxelize/leaf/print_columns.h"

#include <openvdb/openvdb.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace stratum::ondemand {

/// Immutable; shared by all threads.
struct PrintLayout {
    /// `selection`: indices into toolpath->beads, ascending, not empty. `unit` is world units a mm. Parallel. Throws
    /// UsageError if the bins don't fit.
    PrintLayout(std::shared_ptr<const gcode::Toolpath> toolpath, std::span<const std::uint32_t> selection,
                const voxelize::Lattice& lattice, double unit);

    /// The leaf column that holds the samples (i, j, *), if any bead reaches it.
    std::optional<std::size_t> columnOf(int i, int j) const;
    std::size_t bytes() const;

    const std::shared_ptr<const gcode::Toolpath> toolpath;
    const voxelize::Lattice lattice;
    const double unit;
    const voxelize::LayerStack stack;
    const voxelize::PrintColumns columns;
    const double reach;  ///< mm: a layer's center plane affects leaves within this distance; of the thickest layer
};

/// Evaluates single leaves at any position. Belongs to one thread.
class LeafMaker {
public:
    /// `layout` must outlive it.
    explicit LeafMaker(const PrintLayout& layout)
        : layout_(layout),
          column_(*layout.toolpath, layout.stack, layout.lattice, layout.unit, voxelize::LeafColumn::Kind::kept) {}

    /// Evaluates the leaf from this index-space coordinate, and optionally the plane above it, of the beads below index
    /// `end`. The values are column().planes().
    voxelize::LeafContent make(const openvdb::Coord& origin, std::uint32_t end,
                               std::size_t planes = voxelize::kLeafPlanes);
    const voxelize::LeafColumn& column() const { return column_; }
    /// LeafColumn::owners() of that leaf.
    void owners(std::span<std::uint32_t, voxelize::Leaf::SIZE> ranks) { column_.owners(ranks); }

private:
    const PrintLayout& layout_;
    voxelize::LeafColumn column_;
    std::vector<std::uint32_t> ranks_;
};

}  // namespace stratum::ondemand
