// What the beads of a print are, asked where rays hit: attributes without their grids.
#pragma once

#include "march/attribute/attribute_grid.h"
#include "ondemand/print_field.h"
#include "trace/attribute.h"
#include "voxelize/grid/attributes.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

namespace stratum::ondemand {

/// The attribute of that name, as --grids calls it. Throws UsageError, with the names that there are.
voxelize::Attribute attributeNamed(std::string_view name);

/// The values of the grid that voxelize::Voxelizer::attributes() would make, found when they are asked for: the voxel
/// of the eight around a point that is nearest to it, and the bead nearest to that. The leaves lately asked for are
/// kept, a few a thread.
std::shared_ptr<const march::AttributeSource> makePrintAttribute(std::shared_ptr<const PrintField> field,
                                                                 voxelize::Attribute attribute);

/// What march::summarize() would say of that grid, from the selected beads: also from those that no voxel is nearest
/// to.
trace::AttributeSummary summarize(const PrintField& field, voxelize::Attribute attribute,
                                  std::span<const std::uint32_t> selection);

}  // namespace stratum::ondemand
