#include "march/file/leaf_places.h"

#include <blosc.h>

#include <cstring>
#include <limits>
#include <string>

namespace stratum::march {
namespace {

/// The list as io::DelayedLoadMetadata has it, which asks a table of all types of metadata, behind a lock, for each
/// leaf: that took longer than anything else about opening a file.
struct LeafList {
    std::vector<std::int8_t> kinds;
    std::vector<std::int64_t> lengths;  // of the values; empty if they follow from the masks
};

template <typename T>
std::vector<T> arrayOf(VdbCursor& cursor, std::uint32_t packed, std::size_t count) {
    std::vector<T> values(count);
    const std::size_t length = count * sizeof(T);
    if (packed == 0) {
        std::memcpy(values.data(), cursor.take(length).data(), length);
        return values;
    }
    const std::string_view data = cursor.take(packed);
    const auto unpacked = static_cast<std::size_t>(listedArrayBytes(length));
    values.resize(unpacked / sizeof(T));
    if (blosc_decompress_ctx(data.data(), values.data(), unpacked, 1) != static_cast<std::int64_t>(unpacked))
        cursor.fail("a packed list of leaves");
    values.resize(count);
    return values;
}

LeafList listOf(const VdbGrid& grid, std::size_t leaves, const std::string& where) {
    VdbCursor cursor(grid.sizes, where);
    (void)cursor.take(2 * sizeof(std::uint32_t));  // their bytes and how many they are
    LeafList list;
    list.kinds = arrayOf<std::int8_t>(cursor, cursor.read<std::uint32_t>(), leaves);
    if (const auto packed = cursor.read<std::uint32_t>(); packed != std::numeric_limits<std::uint32_t>::max())
        list.lengths = arrayOf<std::int64_t>(cursor, packed, leaves);
    return list;
}

}  // namespace

std::optional<LeafPlaces> listedLeafPlaces(const VdbCursor& cursor, const VdbGrid& grid, const VdbValueFormat& format,
                                           const std::vector<std::string_view>& masks) {
    std::size_t leaves = 0;
    for (const std::string_view of_node : masks) leaves += of_node.size() / kLeafMaskBytes;
    if (leaves == 0 || grid.listed != leaves) return std::nullopt;
    const LeafList list = listOf(grid, leaves, cursor.where());
    const bool packed = (format.compression & (kVdbBlosc | kVdbZip)) != 0;
    if (packed && list.lengths.empty()) return std::nullopt;
    const bool active_only = (format.compression & kVdbActiveOnly) != 0;
    LeafPlaces places = {cursor.offset()};
    places.reserve(leaves + 1);
    for (std::string_view of_node : masks)
        for (; !of_node.empty(); of_node.remove_prefix(kLeafMaskBytes)) {
            const std::size_t n = places.size() - 1;
            const int kind = active_only ? int{list.kinds[n]} : int{VdbValues::kAllStored};
            const std::uint64_t values = packed
                                             ? static_cast<std::uint64_t>(list.lengths[n])
                                             : format.bytesOf(format.storedOf(kind, of_node.substr(0, kLeafMaskBytes)));
            places.push_back(places.back() + kLeafMaskBytes + 1 + VdbValues::inactiveOf(kind) * format.whole +
                             (VdbValues::hasMask(kind) ? kLeafMaskBytes : 0) + values);
        }
    if (places.back() != static_cast<std::uint64_t>(grid.end)) return std::nullopt;
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
