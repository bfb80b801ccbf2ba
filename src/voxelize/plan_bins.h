// LayerStack -> which beads reach which leaf column: the 8 x 8 voxel columns that OpenVDB's leaves stand in.
#pragma once

#include "gcode/toolpath.h"
#include "voxelize/lattice.h"
#include "voxelize/layer_stack.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace stratum::voxelize {

/// Voxels along the edge of a leaf, and of a leaf column in the plane.
constexpr int kLeafDim = 8;

/// One bead that reaches one leaf column. `layer` is LayerStack::layers.size() for a direct bead.
struct BinEntry {
    std::uint32_t layer = 0;
    std::uint32_t bead = 0;
};

/// Entries by leaf column in CSR form; within a column they ascend by layer, direct beads last.
class PlanBins {
public:
    /// Bins every bead whose band reaches a column. Throws UsageError if that needs more than `memory_limit` bytes.
    PlanBins(const gcode::Toolpath& toolpath, const LayerStack& stack, const Lattice& lattice,
             std::size_t memory_limit);

    /// Columns of the bounding rectangle, row by row; many may be empty.
    std::size_t size() const { return offsets_.empty() ? 0 : offsets_.size() - 1; }
    std::span<const BinEntry> operator[](std::size_t column) const {
        return {entries_.data() + offsets_[column], entries_.data() + offsets_[column + 1]};
    }
    /// Index-space coordinate of the first voxel of a column: a multiple of kLeafDim.
    int originI(std::size_t column) const { return (first_i_ + static_cast<int>(column % columns_i_)) * kLeafDim; }
    int originJ(std::size_t column) const { return (first_j_ + static_cast<int>(column / columns_i_)) * kLeafDim; }

    std::size_t entryCount() const { return entries_.size(); }

private:
    int first_i_ = 0, first_j_ = 0;  // in columns
    std::size_t columns_i_ = 0, columns_j_ = 0;
    std::vector<std::size_t> offsets_;
    std::vector<BinEntry> entries_;
};

}  // namespace stratum::voxelize
