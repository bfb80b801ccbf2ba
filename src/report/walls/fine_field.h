// The level set near a line that goes up a wall, finer than that of the whole print: leaves are made where it is asked
// for.
#pragma once

#include "report/level_set/field_probe.h"
#include "voxelize/beads/plan_bins.h"
#include "voxelize/leaf/leaf_column.h"

#include <array>
#include <cstdint>
#include <map>
#include <vector>

namespace stratum::report {

/// One thread's, for one line. All it refers to must outlive it.
class FineField {
public:
    /// Of the beads that are near any height between `z_min` and `z_max` (mm).
    FineField(const gcode::Toolpath& toolpath, const voxelize::LayerStack& stack, const voxelize::Lattice& lattice,
              double z_min, double z_max);
    FineField(const FineField&) = delete;
    FineField& operator=(const FineField&) = delete;

    /// Of the trilinear field, mm; negative inside. Only between those heights.
    double value(const Point& p);

private:
    using Place = std::array<int, 3>;  // of a leaf, in leaves
    using Values = std::array<float, voxelize::Leaf::SIZE>;

    const Values& leafAt(const Place& place);
    void make(const Place& place, Values& values);
    void open(int i, int j);

    const voxelize::Lattice lattice_;
    voxelize::LeafColumn column_;
    std::vector<std::uint32_t> ranks_;            // of the beads, ascending
    std::vector<voxelize::ColumnRange> columns_;  // of each, where it may be
    std::vector<std::uint32_t> open_ranks_;
    std::map<Place, Values> leaves_;
    Place last_place_{};
    const Values* last_ = nullptr;
};

}  // namespace stratum::report
