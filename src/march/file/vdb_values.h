// The values of a node of a .vdb, unpacked.
#pragma once

#include "march/file/vdb_walker.h"

#include <string_view>

namespace stratum::march {

/// What io::readCompressedValues() makes of values that were walked through: unpacks Blosc and zip, widens halves, and
/// puts the inactive values in their places. T is float, std::int32_t or openvdb::Vec3f. From any thread.
/// @param cursor  for messages; throws InputError for data that can't be unpacked
/// @param active  a bit a value
/// @param out  room for a value a bit
template <typename T>
void unpackVdbValues(const VdbCursor& cursor, const VdbValues& values, const VdbValueFormat& format,
                     std::string_view active, const T& background, T* out);

}  // namespace stratum::march
