// Where the leaves of a tree are in a .vdb.
#pragma once

#include "march/file/vdb_walker.h"

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace stratum::march {

/// Offsets of the leaves' values, in the file's order, and where the last one ends: one more than leaves.
using LeafPlaces = std::vector<std::uint64_t>;

/// By the sizes that the file lists (io::DelayedLoadMetadata), without touching the leaves. Nothing if it has no such
/// list, or one that does not end where the grid ends.
/// @param cursor  at the first leaf
/// @param masks  of the leaves below each lower node, as VdbTreeVisitor has them
std::optional<LeafPlaces> listedLeafPlaces(const VdbCursor& cursor, const VdbGrid& grid, const VdbValueFormat& format,
                                           const std::vector<std::string_view>& masks);

/// By walking through all leaves. Throws InputError unless they are whole and have the masks of the upper levels; what
/// is packed is not unpacked.
/// @param cursor  at the first leaf, afterwards behind the last
LeafPlaces walkLeafPlaces(VdbCursor& cursor, const VdbValueFormat& format, const std::vector<std::string_view>& masks);

/// The values of the leaf at the cursor, which moves behind them. Throws InputError unless it has this mask, which
/// OpenVDB counts its values by: masks are in the file twice.
VdbValues walkVdbLeaf(VdbCursor& cursor, const VdbValueFormat& format, std::string_view mask);

}  // namespace stratum::march
