// LayerStack -> the beads that reach each leaf column, the 8 x 8 voxel columns of OpenVDB's leaves.
#pragma once

#include "base/huge_array.h"
#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/footprint.h"
#include "voxelize/beads/lattice.h"
#include "voxelize/beads/layer_stack.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace stratum::voxelize {

/// Voxels along the edge of a leaf, and of a leaf column in the plane.
constexpr int kLeafDim = 8;

/// Finds the leaf columns that a bead's field reaches.
inline Footprints columnFootprints(const gcode::Toolpath& toolpath, const Lattice& lattice) {
    return {toolpath, lattice.voxel_size * kLeafDim, 0.5 * (kLeafDim - 1) * lattice.voxel_size, lattice.background(),
            Footprints::Reach::field};
}

/// Ranks of beads (see LayerStack) by leaf column, in CSR form; ascending within a column, so layer by layer with the
/// direct beads last.
class PlanBins {
public:
    /// Bins every bead whose band reaches a column. Parallel; the result does not depend on the number of threads.
    /// Throws UsageError if that needs more than half of `free_memory` bytes.
    PlanBins(const gcode::Toolpath& toolpath, const LayerStack& stack, const Lattice& lattice, std::size_t free_memory);

    /// Columns of the bounding rectangle, row by row; many may be empty.
    std::size_t size() const { return offsets_.empty() ? 0 : offsets_.size() - 1; }
    std::span<const std::uint32_t> operator[](std::size_t column) const {
        return {ranks_.data() + offsets_[column], ranks_.data() + offsets_[column + 1]};
    }
    /// Index-space coordinate of the first voxel of a column: a multiple of kLeafDim.
    int originI(std::size_t column) const { return (first_i_ + static_cast<int>(column % columns_i_)) * kLeafDim; }
    int originJ(std::size_t column) const { return (first_j_ + static_cast<int>(column / columns_i_)) * kLeafDim; }

    std::size_t columnsI() const { return columns_i_; }
    std::size_t columnsJ() const { return columns_j_; }
    std::size_t entryCount() const { return ranks_.size(); }
    std::size_t bytes() const {
        return offsets_.capacity() * sizeof(std::size_t) + ranks_.size() * sizeof(std::uint32_t);
    }

private:
    int first_i_ = 0, first_j_ = 0;  // in columns
    std::size_t columns_i_ = 0, columns_j_ = 0;
    std::vector<std::size_t> offsets_;
    HugeArray<std::uint32_t> ranks_;
};

}  // namespace stratum::voxelize
