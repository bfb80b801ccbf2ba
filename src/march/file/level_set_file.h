// Opens a .vdb, selects the level set to trace, and refuses those that can't be traced.
#pragma once

#include "march/file/leaf_file.h"
#include "trace/intersector.h"

#include <openvdb/openvdb.h>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

namespace stratum::march {

/// Reads the level set of that name; an empty name selects "surface", or else the only level set in the file.
/// Throws InputError for a missing or damaged file, no level set, or several to choose from.
openvdb::FloatGrid::Ptr readLevelSet(const std::filesystem::path& path, const std::string& name = "");

/// The same without reading its leaves, for lazy bricks. Null for files that only OpenVDB can read: see
/// LeafFile::open(). Throws as readLevelSet(), except for damage inside leaves, which is found when they are read.
std::shared_ptr<const LeafFile> openLevelSet(const std::filesystem::path& path, const std::string& name = "");

/// Whether a .vdb holds a grid of that name, of whatever type. Throws InputError for a missing or damaged file.
bool hasGrid(const std::filesystem::path& path, const std::string& name);

/// Throws InputError, beginning with `where`, unless the grid is a level set that rays can be traced through: class,
/// not empty, a linear transform without shear (voxels may be turned boxes of any edges), half-width of at least 2 of
/// the shortest edges.
void requireTraceable(const openvdb::FloatGrid& grid, const std::string& where);
/// The same for a grid whose leaves are in `leaves`.
void requireTraceable(const openvdb::FloatGrid& grid, std::size_t leaves, const std::string& where);

/// World-space box of the active voxels' sample points, for any orientation of the transform.
trace::Box worldBounds(const openvdb::math::Transform& transform, const openvdb::CoordBBox& active);
trace::Box narrowBandBounds(const openvdb::FloatGrid& grid);

}  // namespace stratum::march
