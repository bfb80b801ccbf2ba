#include "voxelize/leaf/print_columns.h"

namespace stratum::voxelize {

PrintColumns::PrintColumns(const gcode::Toolpath& toolpath, const LayerStack& stack, const Lattice& lattice,
                           double scale, LeafColumn::Kind kind, std::size_t free_memory)
    : toolpath_(toolpath),
      stack_(stack),
      lattice_(lattice),
      scale_(scale),
      bins_(toolpath, stack, lattice, free_memory),
      threads_([this, kind] { return LeafColumn(toolpath_, stack_, lattice_, scale_, kind); }) {}

}  // namespace stratum::voxelize
