// One leaf column: plan fields of its layers, expanded along z into leaves.
#pragma once

#include "gcode/toolpath.h"
#include "voxelize/lattice.h"
#include "voxelize/layer_stack.h"
#include "voxelize/plan_bins.h"

#include <openvdb/openvdb.h>

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace stratum::voxelize {

using Leaf = openvdb::FloatTree::LeafNodeType;

/// What one column contributes to the grid. Leaves are owned by whoever takes them over.
struct ColumnLeaves {
    std::vector<Leaf*> leaves;                 ///< with at least one active voxel, ascending in z
    std::vector<openvdb::Coord> inside_tiles;  ///< origins of leaf positions that are deep inside
};

/// Scratch of one thread: builds columns one after the other.
class LeafColumn {
public:
    /// `scale` turns mm into the grid's world unit. The references must outlive the object.
    LeafColumn(const gcode::Toolpath& toolpath, const LayerStack& stack, const Lattice& lattice, double scale);

    /// Evaluates the column whose first voxel is (i, j) from the beads that reach it.
    void build(int i, int j, std::span<const BinEntry> entries, ColumnLeaves& out);

    /// An upper bound on the leaves of a column, from z extents alone.
    std::size_t countLeaves(std::span<const BinEntry> entries);

private:
    static constexpr std::size_t kColumns = std::size_t{kLeafDim} * kLeafDim;
    static constexpr std::size_t column(int x, int y) {
        return static_cast<std::size_t>(x) * kLeafDim + static_cast<std::size_t>(y);
    }
    // D = min(rho - c) of one layer over the column's 8 x 8 samples, mm; index x * 8 + y, as in a leaf.
    using PlanField = std::array<double, kColumns>;
    struct PlanLayer {
        std::uint32_t layer;
        double centre_z, radius;  // mm
        PlanField d;
    };
    struct PlanWeld {
        double middle_z, half;  // mm
        PlanField d;            // max of the two layers
    };
    using LeafRange = std::pair<int, int>;  // first and last leaf along z, in leaves

    double sampleZ(int k) const { return lattice_.origin_z + k * lattice_.voxel_size; }
    LeafRange leafRange(double z_min, double z_max) const;
    void gatherLayers(int i, int j, std::span<const BinEntry> entries);
    void gatherWelds();
    void evaluate(int i, int j, int leaf_k, std::span<const BinEntry> direct);
    void store(int i, int j, int leaf_k, ColumnLeaves& out) const;

    const gcode::Toolpath& toolpath_;
    const LayerStack& stack_;
    const Lattice& lattice_;
    const double scale_;
    std::vector<std::size_t> weld_offsets_;  // CSR over stack_.welds by lower layer
    std::vector<PlanLayer> layers_;
    std::vector<PlanWeld> welds_;
    std::vector<LeafRange> ranges_;
    std::array<double, kColumns * kLeafDim> phi_{};  // mm, in leaf order
};

}  // namespace stratum::voxelize
