#include "voxelize/leaf/print_columns.h"

namespace stratum::voxelize {

PrintColumns::PrintColumns(const gcode::Toolpath& toolpath, const LayerStack& stack, const Lattice& lattice,
                           double scale, LeafColumn::Kind kind, std::size_t free_memory)
    : toolpath_(toolpath),
      stack_(stack),
      lattice_(lattice),
      scale_(scale),
      bins_(std::make_shared<const PlanBins>(toolpath, stack, lattice, free_memory)),
      threads_([this, kind] { return LeafColumn(toolpath_, stack_, lattice_, scale_, kind); }) {}

PrintColumns::PrintColumns(const PrintColumns& of, LeafColumn::Kind kind)
    : toolpath_(of.toolpath_),
      stack_(of.stack_),
      lattice_(of.lattice_),
      scale_(of.scale_),
      bins_(of.bins_),
      threads_([this, kind] { return LeafColumn(toolpath_, stack_, lattice_, scale_, kind); }) {}

}  // namespace stratum::voxelize
