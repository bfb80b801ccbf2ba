#include "march/file/vdb_walker.h"

#include "base/error.h"

#include <blosc.h>
#include <fmt/format.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/math/Half.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <ios>
#include <limits>
#include <memory>
#include <sstream>
#include <type_traits>

namespace stratum::march {
namespace {

// Formats: 222 is of 2013; 225, of OpenVDB 13, differs from 224 only in that grids of halves may be in it.
constexpr std::uint32_t kOldest = 222, kNewest = 225;
constexpr std::string_view kSizes = "file_delayed_load";
constexpr std::int32_t kFarthest = 1 << 30;  // voxels: farther ones have neighbours that no int can count

// --- metadata and transforms ----------------------------------------------------------------------------------------

void requireBlosc(const VdbCursor& cursor, std::string_view packed, std::uint64_t length) {
    std::size_t unpacked = 0;
    if (blosc_cbuffer_validate(packed.data(), packed.size(), &unpacked) != 0 || unpacked != length)
        cursor.fail("packed data of another size");
}

/// The list of the leaves' sizes, io::DelayedLoadMetadata::readValue(). Returns how many they are.
std::uint64_t checkLeafSizes(VdbCursor value, std::uint32_t compression) {
    const std::uint64_t count = value.read<std::uint32_t>();
    const auto checkArray = [&](std::uint32_t packed, std::uint64_t length) {
        if (packed > 0)
            requireBlosc(value, value.take(packed), listedArrayBytes(length));
        else
            (void)value.take(length);
    };
    checkArray(value.read<std::uint32_t>(), count);
    const auto packed = value.read<std::uint32_t>();
    if (packed != std::numeric_limits<std::uint32_t>::max())
        checkArray(packed, count * sizeof(std::int64_t));
    else if ((compression & (kVdbZip | kVdbBlosc)) != 0)
        value.fail("a list of leaves without their sizes");
    return count;
}

void checkMetadata(VdbCursor& cursor, VdbGrid* grid) {
    constexpr std::string_view kHalf = "is_saved_as_half_float";
    bool half = false;
    const std::uint64_t first = cursor.offset();
    for (auto rest = cursor.read<std::uint32_t>(); rest > 0; --rest) {
        const std::string name = cursor.text();
        const std::string type = cursor.text();
        const std::string_view value = cursor.take(cursor.read<std::uint32_t>());
        const bool sizes = type == "__delayedload";
        if (sizes != (name == kSizes) || (sizes && (grid == nullptr || grid->listed)))
            cursor.fail("a list of leaves where there is none");
        if (sizes) {
            constexpr std::size_t kLength = sizeof(std::uint32_t);
            grid->sizes = {value.data() - kLength, kLength + value.size()};
            grid->listed = value.empty() ? 0 : checkLeafSizes(VdbCursor(value, cursor.where()), grid->compression);
        }
        // All but texts have a size of their own and are read by it.
        if (!sizes && type != "string" && openvdb::Metadata::isRegisteredType(type) &&
            openvdb::Metadata::createMetadata(type)->size() != value.size())
            cursor.fail(fmt::format("{} of another size than its type {}", name, type));
        if (name != kHalf) continue;
        if (type != "bool") cursor.fail(fmt::format("{} that is neither true nor false", kHalf));
        half = value[0] != 0;
    }
    if (grid == nullptr) return;
    if (half != grid->half) cursor.fail("half-float flags disagree");
    grid->metadata = cursor.since(first);
}

// A stream of bytes that OpenVDB reads.
std::istringstream streamOf(std::string_view bytes, const VdbHeads& heads) {
    std::istringstream in{std::string(bytes)};
    in.exceptions(std::ios::badbit | std::ios::failbit);
    openvdb::io::setVersion(in, {}, heads.format);
    return in;
}

/// Its bytes.
std::string_view checkTransform(VdbCursor& cursor) {
    const std::uint64_t first = cursor.offset();
    const auto all = [&] { return cursor.since(first); };
    const std::string type = cursor.text();
    std::size_t doubles = 0;
    if (type == "AffineMap" || type == "UnitaryMap")
        doubles = 16;
    else if (type == "ScaleMap" || type == "UniformScaleMap")
        doubles = 15;
    else if (type == "ScaleTranslateMap" || type == "UniformScaleTranslateMap")
        doubles = 18;
    else if (type == "TranslationMap")
        doubles = 3;
    else if (type == "NonlinearFrustumMap")
        doubles = 8;  // and a map behind it, which OpenVDB takes for an affine one whatever it says
    else
        cursor.fail("an unknown transform");
    for (std::size_t n = 0; n < doubles; ++n)
        if (!std::isfinite(cursor.read<double>())) cursor.fail("a transform that is no number");
    if (type != "NonlinearFrustumMap") return all();
    if (cursor.text() != "AffineMap") cursor.fail("a frustum of an unknown kind");
    for (int n = 0; n < 16; ++n)
        if (!std::isfinite(cursor.read<double>())) cursor.fail("a transform that is no number");
    return all();
}

// --- the file -------------------------------------------------------------------------------------------------------

std::uint32_t checkHeader(VdbCursor& cursor) {
    if (cursor.take(kVdbMagic.size()) != kVdbMagic) cursor.fail("not a VDB file");
    const auto version = cursor.read<std::uint32_t>();
    if (version < kOldest || version > kNewest)
        throw InputError(
            fmt::format("{}: is a .vdb of format {}; {} to {} can be read. Save it again with another OpenVDB",
                        cursor.where(), version, kOldest, kNewest));
    (void)cursor.take(2 * sizeof(std::uint32_t));  // version of the library
    if (cursor.read<char>() == 0)
        throw InputError(
            fmt::format("{}: was written as a stream, without places of its grids; save it as a file", cursor.where()));
    constexpr std::size_t kUuid = 36;
    (void)cursor.take(kUuid);
    return version;
}

VdbGrid readDescriptor(VdbCursor& cursor) {
    constexpr std::string_view kHalf = "_HalfFloat";
    VdbGrid grid;
    grid.name = cursor.text();
    grid.type = cursor.text();
    if (grid.type.ends_with(kHalf)) {
        grid.half = true;
        grid.type.resize(grid.type.size() - kHalf.size());
    }
    grid.parent = cursor.text();
    grid.offset = cursor.read<std::int64_t>();
    grid.leaves = cursor.read<std::int64_t>();
    grid.end = cursor.read<std::int64_t>();
    // The next one is there: never before this one, or a list would have no end.
    if (grid.end < 0 || static_cast<std::uint64_t>(grid.end) < cursor.offset()) cursor.fail("grids that overlap");
    cursor.moveTo(grid.end);
    return grid;
}

// --- trees ----------------------------------------------------------------------------------------------------------

/// Of a node of 4096^3 voxels.
openvdb::Coord readOrigin(VdbCursor& cursor) {
    const auto at = cursor.read<std::array<std::int32_t, 3>>();
    for (const std::int32_t c : at)
        if (c % 4096 != 0 || c < -kFarthest || c > kFarthest) cursor.fail("a node where none can be");
    return {at[0], at[1], at[2]};
}

VdbNode readNode(VdbCursor& cursor, const VdbValueFormat& format, const openvdb::Coord& origin, int log2_edge,
                 int child_log2) {
    VdbNode node;
    node.origin = origin;
    node.log2_edge = log2_edge;
    node.child_log2 = child_log2;
    const std::uint64_t mask = (std::uint64_t{1} << (3 * log2_edge)) / 8;
    node.children = cursor.take(mask);
    node.active = cursor.take(mask);
    for (std::size_t n = 0; n < mask; ++n)
        if ((node.children[n] & node.active[n]) != 0) cursor.fail("a child that is a tile, too");
    node.values = walkVdbValues(cursor, format, node.active);
    return node;
}

}  // namespace

void VdbCursor::fail(std::string_view why) const {
    throw InputError(fmt::format("{}: is not a readable .vdb file ({} about byte {}); is it cut short?", where_,
                                 grid_ != nullptr ? fmt::format("the grid {} is damaged", *grid_) : why, offset_));
}

void VdbCursor::moveTo(std::int64_t offset) {
    if (offset < 0 || static_cast<std::uint64_t>(offset) > bytes_.size()) fail("a place beyond its end");
    offset_ = static_cast<std::size_t>(offset);
}

std::uint64_t listedArrayBytes(std::uint64_t length) {
    constexpr std::uint64_t kShortest = 48;
    constexpr std::uint64_t kFilledUp = 128;
    return length > kShortest && length < kFilledUp ? kFilledUp : length;
}

VdbHeads walkVdbHeads(VdbCursor& cursor) {
    VdbHeads heads;
    heads.format = checkHeader(cursor);
    checkMetadata(cursor, nullptr);
    const auto count = cursor.read<std::int32_t>();
    if (count < 0) cursor.fail("less than no grids");
    // No room is made for them beforehand: the count is not believed until they are there.
    while (heads.grids.size() < static_cast<std::size_t>(count)) heads.grids.push_back(readDescriptor(cursor));
    for (VdbGrid& grid : heads.grids) {
        cursor.moveTo(grid.offset);
        grid.compression = cursor.read<std::uint32_t>();
        checkMetadata(cursor, &grid);
        grid.transform = checkTransform(cursor);
        grid.tree = cursor.offset();
    }
    return heads;
}

std::string nameOf(const VdbGrid& grid) { return openvdb::io::GridDescriptor::nameAsString(grid.name); }

openvdb::math::Transform::Ptr transformOf(const VdbHeads& heads, const VdbGrid& grid) {
    auto in = streamOf(grid.transform, heads);
    auto transform = openvdb::math::Transform::createLinearTransform();
    transform->read(in);
    return transform;
}

openvdb::GridBase::Ptr headOf(const VdbHeads& heads, const VdbGrid& grid) {
    if (!openvdb::GridBase::isRegistered(grid.type)) return nullptr;
    openvdb::GridBase::Ptr head = openvdb::GridBase::createGrid(grid.type);
    auto in = streamOf(grid.metadata, heads);
    openvdb::io::setDataCompression(in, grid.compression);
    head->readMeta(in);
    head->removeMeta(std::string(kSizes));  // which is of the file
    head->setTransform(transformOf(heads, grid));
    return head;
}

std::uint64_t VdbValueFormat::storedOf(int kind, std::string_view active) const {
    const bool some = (compression & kVdbActiveOnly) != 0 && kind != VdbValues::kAllStored;
    return some ? countOn(active) : active.size() * 8;
}

std::optional<VdbValueFormat> valueFormatOf(const VdbGrid& grid) {
    if (grid.type == "Tree_float_5_4_3") return VdbValueFormat{4, grid.half ? 2U : 0U, grid.compression};
    if (grid.type == "Tree_int32_5_4_3") return VdbValueFormat{4, 0, grid.compression};
    if (grid.type == "Tree_vec3s_5_4_3") return VdbValueFormat{12, grid.half ? 6U : 0U, grid.compression};
    return std::nullopt;
}

VdbValues walkVdbValues(VdbCursor& cursor, const VdbValueFormat& format, std::string_view active) {
    VdbValues values;
    values.kind = cursor.read<std::uint8_t>();
    if (values.kind > VdbValues::kAllStored) cursor.fail("values of an unknown kind");
    const std::size_t inactive = VdbValues::inactiveOf(values.kind) * format.whole;
    const std::string_view before = cursor.take(inactive + (VdbValues::hasMask(values.kind) ? active.size() : 0));
    values.inactive = before.substr(0, inactive);
    values.chosen = before.substr(inactive);
    values.stored = format.storedOf(values.kind, active);
    // OpenVDB writes nothing for no halves, but a length for no floats.
    if (format.half != 0 && values.stored == 0) return values;
    values.length = format.bytesOf(values.stored);
    if ((format.compression & (kVdbZip | kVdbBlosc)) == 0) {
        values.data = cursor.take(values.length);
        return values;
    }
    const auto packed = cursor.read<std::int64_t>();
    values.packed = packed > 0;
    // Unsigned: the least of a damaged file has no opposite.
    if (!values.packed && 0 - static_cast<std::uint64_t>(packed) != values.length)
        cursor.fail("values of another number");
    values.data = cursor.take(values.packed ? static_cast<std::uint64_t>(packed) : values.length);
    if (values.packed && (format.compression & kVdbBlosc) != 0) requireBlosc(cursor, values.data, values.length);
    return values;
}

void walkVdbTree(VdbCursor& cursor, const VdbValueFormat& format, VdbTreeVisitor& visitor) {
    constexpr std::size_t kBuffers = sizeof(std::int32_t);  // how many; always one
    visitor.background(cursor.take(kBuffers + format.whole).substr(kBuffers));
    const auto tiles = cursor.read<std::uint32_t>();
    const auto children = cursor.read<std::uint32_t>();
    for (std::uint32_t n = 0; n < tiles; ++n) {
        const openvdb::Coord at = readOrigin(cursor);
        const std::string_view tile = cursor.take(format.whole + 1);
        visitor.tile(at, tile.substr(0, format.whole), tile.back() != 0);
    }
    std::optional<openvdb::Coord> before;
    for (std::uint32_t n = 0; n < children; ++n) {
        const openvdb::Coord at = readOrigin(cursor);
        // OpenVDB writes them in order, reads the leaves in order, and loses one of two at the same place.
        if (before && !(*before < at)) cursor.fail("nodes out of order");
        before = at;
        const VdbNode upper = readNode(cursor, format, at, kUpperLog2, kLowerLog2 + kLeafLog2);
        visitor.upper(upper);
        forEachOn(upper.children, [&](std::size_t child) {
            const VdbNode lower = readNode(cursor, format, upper.originOf(child), kLowerLog2, kLeafLog2);
            visitor.lower(lower, cursor.take(countOn(lower.children) * kLeafMaskBytes));
        });
    }
}

namespace {

constexpr std::size_t kLeafValues = 512;

bool unzips(const VdbValues& values, void* out) {
    if (values.data.size() > std::numeric_limits<uLong>::max()) return false;
    auto length = static_cast<uLongf>(values.length);
    return ::uncompress(static_cast<Bytef*>(out), &length, reinterpret_cast<const Bytef*>(values.data.data()),
                        static_cast<uLong>(values.data.size())) == Z_OK &&
           length == values.length;
}

// To values.length bytes.
void unpackBytes(const VdbCursor& cursor, const VdbValues& values, std::uint32_t compression, void* out) {
    if (values.length == 0) return;
    if (!values.packed) {
        std::memcpy(out, values.data.data(), values.data.size());
        return;
    }
    const bool good = (compression & kVdbBlosc) != 0
                          ? blosc_decompress_ctx(values.data.data(), out, values.length, 1) ==
                                static_cast<std::int64_t>(values.length)
                          : unzips(values, out);
    if (!good) cursor.fail("packed data");
}

// Room for the values of a node; those of a leaf, which are by far the most, need no allocation.
template <typename T>
class Scratch {
public:
    explicit Scratch(std::size_t count) {
        if (count > near_.size()) far_ = std::make_unique_for_overwrite<T[]>(count);
    }
    T* data() { return far_ ? far_.get() : near_.data(); }

private:
    std::array<T, kLeafValues> near_;
    std::unique_ptr<T[]> far_;
};

// The values that are stored.
template <typename T>
void unpackStored(const VdbCursor& cursor, const VdbValues& values, const VdbValueFormat& format, T* out) {
    if (format.half == 0) {
        unpackBytes(cursor, values, format.compression, out);
        return;
    }
    if constexpr (!std::is_integral_v<T>) {
        constexpr std::size_t kComponents = openvdb::VecTraits<T>::Size;
        const std::size_t count = kComponents * static_cast<std::size_t>(values.stored);
        Scratch<std::array<std::uint16_t, kComponents>> halves(static_cast<std::size_t>(values.stored));
        unpackBytes(cursor, values, format.compression, halves.data());
        const auto* const from = reinterpret_cast<const std::uint16_t*>(halves.data());
        auto* const to = reinterpret_cast<float*>(out);
        for (std::size_t n = 0; n < count; ++n) {
            openvdb::math::half half;
            half.setBits(from[n]);
            to[n] = half;
        }
    }
}

// Unsigned for integers: the least of a damaged file has no opposite.
template <typename T>
T opposite(const T& value) {
    if constexpr (std::is_integral_v<T>)
        return static_cast<T>(0 - static_cast<std::make_unsigned_t<T>>(value));
    else
        return -value;
}

}  // namespace

template <typename T>
void unpackVdbValues(const VdbCursor& cursor, const VdbValues& values, const VdbValueFormat& format,
                     std::string_view active, const T& background, T* out) {
    const std::size_t count = active.size() * 8;
    if (values.stored == count) {
        unpackStored(cursor, values, format, out);
        return;
    }
    Scratch<T> stored(static_cast<std::size_t>(values.stored));
    unpackStored(cursor, values, format, stored.data());
    const T* next = stored.data();
    T inactive[2] = {values.kind == VdbValues::kBackground ? background : opposite(background), background};
    std::memcpy(static_cast<void*>(inactive), values.inactive.data(), values.inactive.size());
    for (std::size_t word = 0; word < count / 64; ++word) {
        const std::uint64_t mask = wordOf(active, word);
        const std::uint64_t which = values.chosen.empty() ? 0 : wordOf(values.chosen, word);
        for (std::size_t row = 0; row < 64; row += 8) {
            const std::uint64_t on = mask >> row & 0xff;
            T* const row_to = out + 64 * word + row;
            if (on == 0xff) {
                std::copy_n(next, 8, row_to);
                next += 8;
                continue;
            }
            for (std::size_t bit = 0; bit < 8; ++bit) row_to[bit] = inactive[which >> (row + bit) & 1];
            for (std::uint64_t rest = on; rest != 0; rest &= rest - 1) row_to[std::countr_zero(rest)] = *next++;
        }
    }
}

template void unpackVdbValues(const VdbCursor&, const VdbValues&, const VdbValueFormat&, std::string_view, const float&,
                              float*);
template void unpackVdbValues(const VdbCursor&, const VdbValues&, const VdbValueFormat&, std::string_view,
                              const std::int32_t&, std::int32_t*);
template void unpackVdbValues(const VdbCursor&, const VdbValues&, const VdbValueFormat&, std::string_view,
                              const openvdb::Vec3f&, openvdb::Vec3f*);

}  // namespace stratum::march
