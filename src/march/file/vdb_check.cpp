#include "march/file/vdb_check.h"

#include "base/byte_cursor.h"
#include "base/error.h"

#include <blosc.h>
#include <fmt/format.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <set>
#include <tuple>
#include <vector>

namespace stratum::march {
namespace {

constexpr std::int64_t kMagic = 0x56444220;
constexpr std::uint32_t kOldest = 222, kNewest = 224;  // formats; 222 is of 2013
constexpr std::uint32_t kZip = 1, kActiveOnly = 2, kBlosc = 4;
constexpr std::int32_t kFarthest = 1 << 30;  // voxels: farther ones have neighbours that no int can count

class Cursor : public ByteCursor<Cursor> {
public:
    Cursor(std::string_view bytes, const std::string& where) : ByteCursor(bytes), where_(where) {}

    [[noreturn]] void fail(std::string_view why) const {
        throw InputError(
            fmt::format("{}: is not a readable .vdb file ({} about byte {}); is it cut short?", where_, why, place_));
    }
    [[noreturn]] void endsEarly() const { fail("it ends early"); }
    void moveTo(std::int64_t place) {
        if (place < 0 || static_cast<std::uint64_t>(place) > bytes_.size()) fail("a place beyond its end");
        place_ = static_cast<std::size_t>(place);
    }
    std::string text() { return std::string(take(read<std::uint32_t>())); }

private:
    const std::string& where_;
};

/// What is known of a grid before its tree.
struct Grid {
    std::string name, type, parent;
    bool half = false;
    std::int64_t place = 0;
    std::uint32_t compression = 0;
    std::optional<std::uint64_t> listed;  // leaves, in the list of their sizes
    std::uint64_t tree = 0;               // place
};

/// A name without the number that tells it from others of the same name.
std::string plainName(const std::string& name) { return name.substr(0, name.find_first_of("\x1e[")); }

// --- metadata and transforms ----------------------------------------------------------------------------------------

void checkBlosc(const Cursor& cursor, std::string_view packed, std::uint64_t length) {
    std::size_t unpacked = 0;
    if (blosc_cbuffer_validate(packed.data(), packed.size(), &unpacked) != 0 || unpacked != length)
        cursor.fail("packed data of another size");
}

/// The list of the leaves' sizes, io::DelayedLoadMetadata::readValue(). Returns how many they are.
std::uint64_t checkLeafSizes(Cursor value, std::uint32_t compression) {
    const std::uint64_t count = value.read<std::uint32_t>();
    // OpenVDB's compression::bloscCompress() fills up short arrays with zeros and leaves the shortest as they are.
    constexpr std::uint64_t kShortest = 48;
    constexpr std::uint64_t kFilledUp = 128;
    const auto checkArray = [&](std::uint32_t packed, std::uint64_t length) {
        if (packed > 0)
            checkBlosc(value, value.take(packed), length > kShortest && length < kFilledUp ? kFilledUp : length);
        else
            (void)value.take(length);
    };
    checkArray(value.read<std::uint32_t>(), count);
    const auto packed = value.read<std::uint32_t>();
    if (packed != std::numeric_limits<std::uint32_t>::max())
        checkArray(packed, count * sizeof(std::int64_t));
    else if ((compression & (kZip | kBlosc)) != 0)
        value.fail("a list of leaves without their sizes");
    return count;
}

void checkMetadata(Cursor& cursor, const std::string& where, Grid* grid) {
    constexpr std::string_view kSizes = "file_delayed_load";
    constexpr std::string_view kHalf = "is_saved_as_half_float";
    bool half = false;
    for (auto rest = cursor.read<std::uint32_t>(); rest > 0; --rest) {
        const std::string name = cursor.text();
        const std::string type = cursor.text();
        const std::string_view value = cursor.take(cursor.read<std::uint32_t>());
        const bool sizes = type == "__delayedload";
        if (sizes != (name == kSizes) || (sizes && (grid == nullptr || grid->listed)))
            cursor.fail("a list of leaves where there is none");
        if (sizes) grid->listed = value.empty() ? 0 : checkLeafSizes(Cursor(value, where), grid->compression);
        // All but texts have a size of their own and are read by it.
        if (!sizes && type != "string" && openvdb::Metadata::isRegisteredType(type) &&
            openvdb::Metadata::createMetadata(type)->size() != value.size())
            cursor.fail(fmt::format("{} of another size than its type {}", name, type));
        if (name != kHalf) continue;
        if (type != "bool") cursor.fail(fmt::format("{} that is neither true nor false", kHalf));
        half = value[0] != 0;
    }
    if (grid != nullptr && half != grid->half) cursor.fail("two minds about half floats");
}

void checkTransform(Cursor& cursor) {
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
    if (type != "NonlinearFrustumMap") return;
    if (cursor.text() != "AffineMap") cursor.fail("a frustum of an unknown kind");
    for (int n = 0; n < 16; ++n)
        if (!std::isfinite(cursor.read<double>())) cursor.fail("a transform that is no number");
}

// --- trees ----------------------------------------------------------------------------------------------------------

/// Bytes of a value.
struct ValueKind {
    std::size_t whole = 0;
    std::size_t half = 0;  // 0 if it has no halves
};
std::optional<ValueKind> kindOf(const std::string& type) {
    if (type == "Tree_float_5_4_3") return ValueKind{4, 2};
    if (type == "Tree_int32_5_4_3") return ValueKind{4, 0};
    if (type == "Tree_vec3s_5_4_3") return ValueKind{12, 6};
    return std::nullopt;
}

class TreeCheck {
public:
    TreeCheck(Cursor& cursor, const Grid& grid, ValueKind kind) : cursor_(cursor), grid_(grid), kind_(kind) {}

    void run(bool leaves) {
        cursor_.moveTo(static_cast<std::int64_t>(grid_.tree));
        (void)cursor_.take(sizeof(std::int32_t) + kind_.whole);  // buffers, background
        const auto tiles = cursor_.read<std::uint32_t>();
        const auto children = cursor_.read<std::uint32_t>();
        for (std::uint32_t n = 0; n < tiles; ++n) {
            (void)place();
            (void)cursor_.take(kind_.whole + 1);
        }
        std::optional<std::array<std::int32_t, 3>> before;
        for (std::uint32_t n = 0; n < children; ++n) {
            const auto at = place();
            // OpenVDB writes them in order, reads the leaves in order, and loses one of two at the same place.
            if (before && !(*before < at)) cursor_.fail("nodes out of order");
            before = at;
            std::uint64_t lower = checkNode<5>();
            for (; lower > 0; --lower) {
                const std::uint64_t count = checkNode<4>();
                masks_.push_back(cursor_.take(count * kLeafMask));
                leaves_ += count;
            }
        }
        if (grid_.listed && *grid_.listed != leaves_) cursor_.fail("a list of other leaves");
        if (!leaves) return;
        // Their masks are there twice, and OpenVDB counts a leaf's values by the first.
        for (std::string_view masks : masks_)
            for (; !masks.empty(); masks.remove_prefix(kLeafMask)) {
                const std::string_view mask = cursor_.take(kLeafMask);
                if (mask != masks.substr(0, kLeafMask)) cursor_.fail("a leaf with two masks");
                checkValues(countOn(mask), kLeafMask * 8, kLeafMask);
            }
    }

private:
    static constexpr std::size_t kLeafMask = 64;  // bytes

    static std::uint64_t countOn(std::string_view mask) {
        std::uint64_t on = 0;
        for (std::size_t n = 0; n < mask.size(); n += sizeof(std::uint64_t)) {
            std::uint64_t word = 0;
            std::memcpy(&word, mask.data() + n, sizeof word);
            on += static_cast<std::uint64_t>(std::popcount(word));
        }
        return on;
    }

    /// Of a node of 4096^3 voxels.
    std::array<std::int32_t, 3> place() {
        const auto at = cursor_.read<std::array<std::int32_t, 3>>();
        for (const std::int32_t c : at)
            if (c % 4096 != 0 || c < -kFarthest || c > kFarthest) cursor_.fail("a node where none can be");
        return at;
    }

    /// A node with 2^kLog2Edge children a side; returns how many there are.
    template <int kLog2Edge>
    std::uint64_t checkNode() {
        constexpr std::size_t kCount = std::size_t{1} << (3 * kLog2Edge);
        const std::string_view children = cursor_.take(kCount / 8);
        const std::string_view active = cursor_.take(kCount / 8);
        for (std::size_t n = 0; n < children.size(); ++n)
            if ((children[n] & active[n]) != 0) cursor_.fail("a child that is a tile, too");
        checkValues(countOn(active), kCount, kCount / 8);
        return countOn(children);
    }

    /// io::readCompressedValues().
    void checkValues(std::uint64_t active, std::uint64_t count, std::uint64_t mask_bytes) {
        constexpr int kLast = 6;  // all values are there
        const auto kind = static_cast<int>(cursor_.read<std::uint8_t>());
        if (kind > kLast) cursor_.fail("values of an unknown kind");
        const std::uint64_t inactive = kind == 5 ? 2 : kind == 2 || kind == 4 ? 1 : 0;
        (void)cursor_.take(inactive * kind_.whole + (kind >= 3 && kind <= 5 ? mask_bytes : 0));
        const bool some = (grid_.compression & kActiveOnly) != 0 && kind != kLast;
        const std::uint64_t stored = some ? active : count;
        const bool half = grid_.half && kind_.half != 0;
        if (half && stored == 0) return;
        const std::uint64_t length = stored * (half ? kind_.half : kind_.whole);
        if ((grid_.compression & (kZip | kBlosc)) == 0) {
            (void)cursor_.take(length);
            return;
        }
        const auto packed = cursor_.read<std::int64_t>();
        if (packed > 0) {
            const std::string_view data = cursor_.take(static_cast<std::uint64_t>(packed));
            if ((grid_.compression & kBlosc) != 0) checkBlosc(cursor_, data, length);
        } else {
            // Unsigned: the least of a damaged file has no opposite.
            if (0 - static_cast<std::uint64_t>(packed) != length) cursor_.fail("values of another number");
            (void)cursor_.take(length);
        }
    }

    Cursor& cursor_;
    const Grid& grid_;
    ValueKind kind_;
    std::uint64_t leaves_ = 0;
    std::vector<std::string_view> masks_;  // of the leaves below each node above them
};

// --- the file -------------------------------------------------------------------------------------------------------

void checkHeader(Cursor& cursor, const std::string& where) {
    if (cursor.read<std::int64_t>() != kMagic) cursor.fail("not a VDB file");
    const auto version = cursor.read<std::uint32_t>();
    if (version < kOldest || version > kNewest)
        throw InputError(
            fmt::format("{}: is a .vdb of format {}; {} to {} can be read. Save it again with another OpenVDB", where,
                        version, kOldest, kNewest));
    (void)cursor.take(2 * sizeof(std::uint32_t));  // version of the library
    if (cursor.read<char>() == 0)
        throw InputError(
            fmt::format("{}: was written as a stream, without places of its grids; save it as a file", where));
    constexpr std::size_t kUuid = 36;
    (void)cursor.take(kUuid);
}

Grid readDescriptor(Cursor& cursor) {
    constexpr std::string_view kHalf = "_HalfFloat";
    Grid grid;
    grid.name = cursor.text();
    grid.type = cursor.text();
    if (grid.type.ends_with(kHalf)) {
        grid.half = true;
        grid.type.resize(grid.type.size() - kHalf.size());
    }
    grid.parent = cursor.text();
    grid.place = cursor.read<std::int64_t>();
    (void)cursor.read<std::int64_t>();  // of its leaves
    const auto end = cursor.read<std::int64_t>();
    // The next one is there: never before this one, or a list would have no end.
    if (end < 0 || static_cast<std::uint64_t>(end) < cursor.place()) cursor.fail("grids that overlap");
    cursor.moveTo(end);
    return grid;
}

}  // namespace

void checkVdb(std::string_view bytes, VdbDepth depth, const std::string& name, const std::string& where) {
    Cursor cursor(bytes, where);
    checkHeader(cursor, where);
    checkMetadata(cursor, where, nullptr);
    const auto count = cursor.read<std::int32_t>();
    if (count < 0) cursor.fail("less than no grids");
    std::vector<Grid> grids;
    // No room is made for them beforehand: the count is not believed until they are there.
    while (grids.size() < static_cast<std::size_t>(count)) grids.push_back(readDescriptor(cursor));
    for (Grid& grid : grids) {
        cursor.moveTo(grid.place);
        grid.compression = cursor.read<std::uint32_t>();
        checkMetadata(cursor, where, &grid);
        checkTransform(cursor);
        grid.tree = cursor.place();
    }
    if (depth == VdbDepth::heads) return;
    std::set<std::string> wanted = {plainName(name)};
    for (const Grid& grid : grids)
        if (wanted.contains(plainName(grid.name)) && !grid.parent.empty()) wanted.insert(plainName(grid.parent));
    for (const Grid& grid : grids) {
        const std::optional<ValueKind> kind = kindOf(grid.type);
        if (!wanted.contains(plainName(grid.name)) || !grid.parent.empty()) continue;
        if (!kind) cursor.fail(fmt::format("a grid of type {}", grid.type));
        TreeCheck(cursor, grid, *kind).run(depth == VdbDepth::leaves);
    }
}

}  // namespace stratum::march
