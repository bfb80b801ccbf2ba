// Whether a .vdb is as long as it says, part by part, before OpenVDB believes it.
#pragma once

#include "march/file/vdb_walker.h"

#include <cstdint>
#include <string>

namespace stratum::march {

/// How far into the grid that is asked for a check looks.
enum class VdbDepth : std::uint8_t {
    heads,   ///< not at all: the file's own head, and metadata and transforms of all its grids
    nodes,   ///< the upper levels of its tree, a thousandth of the file
    leaves,  ///< all of it
};

/// OpenVDB 10 takes lengths, counts and places as a file gives them: names of 4 GB, lists of 2^31 grids, metadata
/// packed into less memory than they unpack to, transforms of one kind read as another. This walks through what it is
/// going to read (file formats 222 to 225, see vdb_walker.h) and throws InputError, beginning with `where`, unless all
/// of it is in the file and fits together. What is packed is not unpacked: of zlib and Blosc it checks the sizes alone.
/// @param name  of the grid whose tree is about to be read, and with it, if it is an instance, its parent's. Trees of
///              other values than float, int32 and Vec3f are not looked at: don't read them.
void checkVdb(const VdbBytes& bytes, VdbDepth depth, const std::string& name, const std::string& where);

}  // namespace stratum::march
