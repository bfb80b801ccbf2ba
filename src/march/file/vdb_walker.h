// A walk through .vdb files, formats 222 to 225, that checks every length and count: to check a file before OpenVDB
// reads it, and to read leaves one at a time.
//
// Follows io::Archive, io::GridDescriptor, MetaMap, Transform; Tree, RootNode, InternalNode and
// LeafNode::readTopology() and readBuffers(), and io::readCompressedValues(), of OpenVDB 10.
#pragma once

#include "base/byte_cursor.h"
#include "base/input_file.h"

#include <openvdb/openvdb.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::march {

// How a .vdb file begins.

/// OPENVDB_MAGIC of OpenVDB's version.h, as the eight bytes that io::Archive writes.
inline constexpr std::string_view kVdbMagic(" BDV\0\0\0\0", 8);

/// The bytes of a .vdb: in memory, or of a file that is read where a cursor goes. The file must outlive it.
struct VdbBytes {
    VdbBytes(std::string_view all) : bytes(all) {}                          // NOLINT(google-explicit-constructor)
    VdbBytes(const InputFile& from) : bytes(from.unread()), file(&from) {}  // NOLINT(google-explicit-constructor)

    std::string_view bytes;
    const InputFile* file = nullptr;
};

class VdbCursor : public ByteCursor<VdbCursor> {
public:
    /// @param where  how messages begin
    /// @param grid  if given, messages say that this grid is damaged instead of the reason
    VdbCursor(const VdbBytes& bytes, const std::string& where, const std::string* grid = nullptr)
        : ByteCursor(bytes.bytes), file_(bytes.file), where_(where), grid_(grid) {}

    /// Throws InputError.
    [[noreturn]] void fail(std::string_view why) const;
    [[noreturn]] void endsEarly() const { fail("it ends early"); }
    void load(std::size_t offset, std::size_t count) const {
        if (file_ != nullptr) file_->load(offset, count);
    }
    void moveTo(std::int64_t offset);
    std::string text() { return std::string(take(read<std::uint32_t>())); }
    /// The bytes from `first` to here.
    std::string_view since(std::uint64_t first) const {
        return bytes_.substr(static_cast<std::size_t>(first), offset_ - static_cast<std::size_t>(first));
    }
    const std::string& where() const { return where_; }

private:
    const InputFile* file_;
    const std::string& where_;
    const std::string* grid_;
};

/// Bits of VdbGrid::compression.
inline constexpr std::uint32_t kVdbZip = 1, kVdbActiveOnly = 2, kVdbBlosc = 4;

/// A grid's description before its tree. Offsets are in bytes from the beginning of the file.
struct VdbGrid {
    std::string name;    ///< with the number that distinguishes grids of one name
    std::string type;    ///< without the suffix of half floats
    std::string parent;  ///< the grid that it is an instance of; empty: none
    bool half = false;
    std::int64_t offset = 0, leaves = 0, end = 0;
    std::uint32_t compression = 0;
    /// io::DelayedLoadMetadata: the sizes of the leaves, so that their offsets follow without a scan. The bytes begin
    /// with their number.
    std::optional<std::uint64_t> listed;
    std::string_view sizes;
    std::string_view metadata;
    std::string_view transform;
    std::uint64_t tree = 0;
};

struct VdbHeads {
    std::uint32_t format = 0;
    std::vector<VdbGrid> grids;
};

/// Walks through the file's own head, and metadata and transforms of all its grids. Throws InputError unless all of it
/// is in the file and fits together.
VdbHeads walkVdbHeads(VdbCursor& cursor);

/// What a packed array of VdbGrid::sizes unpacks to, of so many bytes: OpenVDB's compression::bloscCompress() fills up
/// short arrays with zeros and leaves the shortest as they are.
std::uint64_t listedArrayBytes(std::uint64_t length);

/// As people know it: grids of one name have a number each, "name[1]".
std::string nameOf(const VdbGrid& grid);

/// As OpenVDB reads it.
openvdb::math::Transform::Ptr transformOf(const VdbHeads& heads, const VdbGrid& grid);

/// The grid without voxels: metadata and transform. Null if OpenVDB has no grids of its type.
openvdb::GridBase::Ptr headOf(const VdbHeads& heads, const VdbGrid& grid);

// --- values ----------------------------------------------------------------------------------------------------------

/// How the values of a grid are stored.
struct VdbValueFormat {
    std::size_t whole = 0;  ///< bytes of a value
    std::size_t half = 0;   ///< bytes of one as halves; 0: they are not stored as halves
    std::uint32_t compression = 0;

    /// How many values of a node are stored, of one whose inactive values are stored in that way.
    /// @param kind  a VdbValues::Kind
    /// @param active  a bit a value
    std::uint64_t storedOf(int kind, std::string_view active) const;
    /// Their bytes, unpacked.
    std::uint64_t bytesOf(std::uint64_t stored) const { return stored * (half != 0 ? half : whole); }
};

/// Of floats, int32 and Vec3f; nothing for other values.
std::optional<VdbValueFormat> valueFormatOf(const VdbGrid& grid);

/// The values of a node, as they are stored.
struct VdbValues {
    /// How the inactive values are stored.
    enum Kind : std::uint8_t {
        kBackground,
        kMinusBackground,
        kOneValue,
        kMaskOfBackgrounds,
        kMaskAndOneValue,
        kMaskAndTwoValues,
        kAllStored
    };
    static bool hasMask(int kind) { return kind >= kMaskOfBackgrounds && kind <= kMaskAndTwoValues; }
    /// How many inactive values are stored.
    static std::size_t inactiveOf(int kind) {
        if (kind == kMaskAndTwoValues) return 2;
        return kind == kOneValue || kind == kMaskAndOneValue ? 1 : 0;
    }

    int kind = kBackground;
    std::string_view inactive;  ///< inactiveOf(kind) values
    std::string_view chosen;    ///< if hasMask(kind): a bit a value: which of the two inactive values
    std::uint64_t stored = 0;   ///< values in `data`
    std::uint64_t length = 0;   ///< their bytes, unpacked
    std::string_view data;
    bool packed = false;
};

/// Packed values are not unpacked, but a Blosc buffer is checked to unpack to `length` bytes.
/// @param active  a bit a value
VdbValues walkVdbValues(VdbCursor& cursor, const VdbValueFormat& format, std::string_view active);

// --- trees -----------------------------------------------------------------------------------------------------------

inline constexpr int kUpperLog2 = 5;  ///< of children a side, in the nodes below the root
inline constexpr int kLowerLog2 = 4;  ///< and in those below them, whose children are leaves
inline constexpr int kLeafLog2 = 3;
inline constexpr std::size_t kLeafMaskBytes = 64;

/// 64 bits of a mask, which need not be aligned.
inline std::uint64_t wordOf(std::string_view mask, std::size_t word) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, mask.data() + word * sizeof bits, sizeof bits);
    return bits;
}

inline std::uint64_t countOn(std::string_view mask) {
    std::uint64_t on = 0;
    for (std::size_t n = 0; n < mask.size() / 8; ++n) on += static_cast<std::uint64_t>(std::popcount(wordOf(mask, n)));
    return on;
}

/// Calls `visit` with the number of each bit that is on.
template <typename Visit>
void forEachOn(std::string_view mask, const Visit& visit) {
    for (std::size_t word = 0; word < mask.size() / 8; ++word)
        for (std::uint64_t rest = wordOf(mask, word); rest != 0; rest &= rest - 1)
            visit(64 * word + static_cast<std::size_t>(std::countr_zero(rest)));
}

/// A node with 2^log2_edge children a side, each of 2^child_log2 voxels a side.
struct VdbNode {
    openvdb::Coord origin;
    int log2_edge = 0, child_log2 = 0;
    std::string_view children, active;
    VdbValues values;  ///< of its tiles

    openvdb::Coord originOf(std::size_t child) const {
        const std::size_t last = (std::size_t{1} << log2_edge) - 1;
        const auto along = [&](std::size_t index) { return static_cast<int>(index & last) << child_log2; };
        return origin.offsetBy(along(child >> (2 * log2_edge)), along(child >> log2_edge), along(child));
    }
};

/// Receives the parts of a tree, in the file's order.
class VdbTreeVisitor {
public:
    virtual ~VdbTreeVisitor() = default;
    virtual void background(std::string_view /*value*/) {}
    /// Of 4096^3 voxels.
    virtual void tile(const openvdb::Coord& /*origin*/, std::string_view /*value*/, bool /*active*/) {}
    virtual void upper(const VdbNode& /*node*/) {}
    /// @param leaf_masks  of the active voxels of its children; they are stored once more beside the leaves' values
    virtual void lower(const VdbNode& /*node*/, std::string_view /*leaf_masks*/) {}
};

/// From the cursor to the first leaf: the upper levels, a thousandth of a file.
void walkVdbTree(VdbCursor& cursor, const VdbValueFormat& format, VdbTreeVisitor& visitor);

// The values of a node of a .vdb, unpacked.

/// What io::readCompressedValues() makes of values that were walked through: unpacks Blosc and zip, widens halves, and
/// puts the inactive values in their places. T is float, std::int32_t or openvdb::Vec3f. From any thread.
/// @param cursor  for messages; throws InputError for data that can't be unpacked
/// @param active  a bit a value
/// @param out  room for a value a bit
template <typename T>
void unpackVdbValues(const VdbCursor& cursor, const VdbValues& values, const VdbValueFormat& format,
                     std::string_view active, const T& background, T* out);

}  // namespace stratum::march
