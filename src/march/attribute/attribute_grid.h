// Reads the attribute grids of a level set, and looks up values at points of its surface.
#pragma once

#include "trace/attribute.h"

#include <openvdb/openvdb.h>
#include <glm/vec3.hpp>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace stratum::march {

/// Reads the grid `name` (of Int32, float or Vec3f) of a .vdb and checks that it lies on the lattice of `surface`.
/// Throws InputError: no such grid, with a list of those in the file; of another type; on another lattice.
openvdb::GridBase::ConstPtr readAttributeGrid(const std::filesystem::path& path, const std::string& name,
                                              const openvdb::FloatGrid& surface);

/// One pass over all active voxels. Metadata "range" (two doubles) replaces the least and the most number: beyond it
/// colors stay the same. Throws InputError if there are more than AttributeSummary::kMostColors colors.
trace::AttributeSummary summarize(const openvdb::GridBase& grid);

/// Belongs to one thread. Keeps a reference to the grid.
class AttributeLookup {
public:
    virtual ~AttributeLookup() = default;
    /// The value of the nearest active voxel among the eight around the point. Values are not interpolated, because
    /// voxels may have values of different beads. Nothing if none of the eight is active.
    /// @param position  world space
    virtual std::optional<glm::vec3> at(const glm::dvec3& position) = 0;
};

std::unique_ptr<AttributeLookup> makeAttributeLookup(const openvdb::GridBase& grid);

/// An attribute of a level set, in a grid or computed. Immutable; shared by all threads.
class AttributeSource {
public:
    virtual ~AttributeSource() = default;
    virtual std::unique_ptr<AttributeLookup> makeLookup() const = 0;
    /// Memory taken.
    virtual std::size_t bytes() const = 0;
};

/// The attribute of a grid; null for null.
std::shared_ptr<const AttributeSource> makeAttributeSource(openvdb::GridBase::ConstPtr grid);

}  // namespace stratum::march
