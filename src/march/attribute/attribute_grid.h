// Attribute grids beside a level set: reading them, and the value at a point of its surface.
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
/// Throws InputError: no such grid, with those that there are; of another type; on another lattice.
openvdb::GridBase::ConstPtr readAttributeGrid(const std::filesystem::path& path, const std::string& name,
                                              const openvdb::FloatGrid& surface);

/// Looks at all active voxels once. Throws InputError if there are more than AttributeSummary::kMostColors colours.
trace::AttributeSummary summarize(const openvdb::GridBase& grid);

/// One a thread. Keeps a reference to the grid.
class AttributeLookup {
public:
    virtual ~AttributeLookup() = default;
    /// The value of that active voxel, of the eight around the point, which is nearest to it: a voxel has the value of
    /// the bead whose surface is nearest, and values of different beads don't mix. Nothing if none of them is active.
    /// @param position  world space
    virtual std::optional<glm::vec3> at(const glm::dvec3& position) = 0;
};

std::unique_ptr<AttributeLookup> makeAttributeLookup(const openvdb::GridBase& grid);

/// An attribute of a level set, wherever its values are kept. Immutable; shared by all threads.
class AttributeSource {
public:
    virtual ~AttributeSource() = default;
    virtual std::unique_ptr<AttributeLookup> makeLookup() const = 0;
    /// Memory taken.
    virtual std::size_t bytes() const = 0;
};

/// That of a grid; null for null.
std::shared_ptr<const AttributeSource> makeAttributeSource(openvdb::GridBase::ConstPtr grid);

}  // namespace stratum::march
