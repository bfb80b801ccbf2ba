// Attributes of beads, looked up at hits, without attribute grids.
#pragma once

#include "march/attribute/attribute_grid.h"
#include "ondemand/print_field.h"
#include "trace/attribute.h"
#include "voxelize/grid/attributes.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

namespace stratum::ondemand {

/// The attribute of that name, as in --grids. Throws UsageError with the list of names.
voxelize::Attribute attributeNamed(std::string_view name);

/// Of one bead: a whole number or a number in x, or a colour.
glm::vec3 valueOf(const voxelize::BeadAttributes& values, voxelize::Attribute attribute, std::uint32_t bead);

/// The values of the grid that voxelize::Voxelizer::attributes() would make, computed on demand, and beyond its narrow
/// band those of the whole inside, which a section shows: of BeadLookup::at(). Each thread caches a few recent leaves.
std::shared_ptr<const march::AttributeSource> makePrintAttribute(std::shared_ptr<const PrintField> field,
                                                                 voxelize::Attribute attribute);

/// For Tracer::grain(): the unit vector, in the field's world space, along which the bead at a place was laid; nothing
/// where there is none, or where it has no length.
std::shared_ptr<const march::AttributeSource> makePrintGrain(std::shared_ptr<const PrintField> field);

/// The march::summarize() of that grid, but from the selected beads, including those that are nearest to no voxel.
trace::AttributeSummary summarize(const PrintField& field, voxelize::Attribute attribute,
                                  std::span<const std::uint32_t> selection);

}  // namespace stratum::ondemand
