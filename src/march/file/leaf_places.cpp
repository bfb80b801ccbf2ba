#include "march/file/leaf_places.h"

#include <openvdb/io/DelayedLoadMetadata.h>

#include <ios>
#include <sstream>
#include <string>

namespace stratum::march {

std::optional<LeafPlaces> listedLeafPlaces(const VdbGrid& grid, const VdbValueFormat& format, std::uint64_t first,
                                           const std::vector<std::string_view>& masks) {
    if (!grid.listed) return std::nullopt;
    openvdb::io::DelayedLoadMetadata list;
    std::istringstream in{std::string(grid.sizes)};
    in.exceptions(std::ios::badbit | std::ios::failbit);
    list.read(in);
    const bool packed = (format.compression & (kVdbBlosc | kVdbZip)) != 0;
    const bool active_only = (format.compression & kVdbActiveOnly) != 0;
    LeafPlaces places = {first};
    places.reserve(*grid.listed + 1);
    for (std::string_view of_node : masks)
        for (; !of_node.empty(); of_node.remove_prefix(kLeafMaskBytes)) {
            const std::size_t n = places.size() - 1;
            if (n == *grid.listed) return std::nullopt;
            const int kind = active_only ? int{list.getMask(n)} : int{VdbValues::kAllStored};
            const std::uint64_t values = packed
                                             ? static_cast<std::uint64_t>(list.getCompressedSize(n))
                                             : format.bytesOf(format.storedOf(kind, of_node.substr(0, kLeafMaskBytes)));
            places.push_back(places.back() + kLeafMaskBytes + 1 + VdbValues::inactiveOf(kind) * format.whole +
                             (VdbValues::hasMask(kind) ? kLeafMaskBytes : 0) + values);
        }
    if (places.size() != *grid.listed + 1 || places.back() != static_cast<std::uint64_t>(grid.end)) return std::nullopt;
    return places;
}

LeafPlaces walkLeafPlaces(VdbCursor& cursor, const VdbValueFormat& format, const std::vector<std::string_view>& masks) {
    LeafPlaces places;
    for (std::string_view of_node : masks)
        for (; !of_node.empty(); of_node.remove_prefix(kLeafMaskBytes)) {
            places.push_back(cursor.offset());
            (void)walkVdbLeaf(cursor, format, of_node.substr(0, kLeafMaskBytes));
        }
    places.push_back(cursor.offset());
    return places;
}

VdbValues walkVdbLeaf(VdbCursor& cursor, const VdbValueFormat& format, std::string_view mask) {
    if (cursor.take(kLeafMaskBytes) != mask) cursor.fail("a leaf with two masks");
    return walkVdbValues(cursor, format, mask);
}

}  // namespace stratum::march
