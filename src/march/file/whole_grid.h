// Reads a whole grid of a .vdb on all threads.
#pragma once

#include "march/file/vdb_walker.h"

#include <openvdb/openvdb.h>

#include <string>

namespace stratum::march {

/// What io::File::readGrid() gives: the same tree, values, masks, metadata and transform. OpenVDB unpacks one leaf
/// after the other; this goes through the upper levels first, which say how many leaves there are and, with the list of
/// their sizes, where; then each leaf is checked and unpacked once, by any thread. Instances of other grids, and grids
/// that share their name, are checked and left to OpenVDB.
///
/// Throws InputError, beginning with the file's name, for a damaged file: of several damages the first in the file,
/// whatever thread meets which first.
/// @param grid  one of `heads`; holds float, int32 or Vec3f
/// @param head  headOf() it, which unpacks the list of its leaves' sizes
/// @param bytes  of the file
/// @param where  the file's path
openvdb::GridBase::Ptr readWholeGrid(const VdbHeads& heads, const VdbGrid& grid, const openvdb::GridBase& head,
                                     const VdbBytes& bytes, const std::string& where);

}  // namespace stratum::march
