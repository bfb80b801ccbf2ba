// The level set near a line that goes up a wall, finer than that of the whole print: leaves are made where it is asked
// for.
#pragma once

#include "report/level_set/field_probe.h"
#include "voxelize/beads/plan_bins.h"
#include "voxelize/leaf/leaf_column.h"

#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace stratum::report {

/// One thread's, for one line. All it refers to must outlive it.
class FineField {
public:
    /// What is within `reach` (mm) of the middle in the plan, and between these heights.
    struct Part {
        double x = 0, y = 0, reach = 0, z_min = 0, z_max = 0;
    };
    FineField(const gcode::Toolpath& toolpath, const voxelize::LayerStack& stack, const voxelize::Lattice& lattice,
              const Part& part);
    FineField(const FineField&) = delete;
    FineField& operator=(const FineField&) = delete;

    /// Of the trilinear field, mm; negative inside. As of the outside beyond the reach. Only between those heights.
    double value(const Point& p);

private:
    using Place = std::array<int, 3>;  // of a leaf, in leaves
    using Values = std::array<float, voxelize::Leaf::SIZE>;

    const Values& leafAt(const Place& place);
    void make(const Place& place, Values& values);
    void open(int i, int j);

    const voxelize::Lattice lattice_;
    const Part part_;
    voxelize::LeafColumn column_;
    std::vector<std::uint32_t> ranks_;                                    // of the beads, ascending
    std::vector<voxelize::ColumnRange> columns_;                          // of each, where it may be
    std::map<std::pair<int, int>, std::vector<std::uint32_t>> ranks_of_;  // by column
    std::map<Place, Values> leaves_;
    Place last_place_{};
    const Values* last_ = nullptr;
};

}  // namespace stratum::report
