#include "march/file/leaf_file.h"

#include "base/error.h"
#include "march/file/vdb_walker.h"

#include <blosc.h>
#include <fmt/format.h>
#include <openvdb/io/GridDescriptor.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <optional>
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

namespace {

float floatOf(std::string_view bytes) {
    float value = 0;
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
}

}  // namespace

// Takes from the upper levels what samples need.
class LeafFile::TreeReader final : public VdbTreeVisitor {
public:
    TreeReader(LeafFile& file, const VdbCursor& cursor) : file_(file), cursor_(cursor) {}
    const std::vector<std::string_view>& masks() const { return masks_; }

private:
    void background(std::string_view value) override {
        file_.head_->tree().root().setBackground(floatOf(value), /*updateChildNodes=*/false);
    }
    void tile(const openvdb::Coord& origin, std::string_view value, bool active) override {
        constexpr int kEdge = 1 << (kUpperLog2 + kLowerLog2 + kLeafLog2);
        file_.root_tiles_[origin] = floatOf(value);
        if (active) file_.active_tiles_.expand(openvdb::CoordBBox::createCube(origin, kEdge));
    }
    void upper(const VdbNode& node) override { takeTiles(node, file_.upper_[node.origin]); }
    void lower(const VdbNode& node, std::string_view leaf_masks) override {
        masks_.push_back(leaf_masks);
        takeTiles(node, file_.lower_[node.origin]);
        forEachOn(node.children, [&](std::size_t leaf) { file_.leaves_.push_back({node.originOf(leaf), 0}); });
    }
    void takeTiles(const VdbNode& node, TileValues& tiles) {
        values_.resize(node.active.size() * 8);
        unpackVdbValues(cursor_, node.values, file_.format_, node.active, file_.background(), values_.data());
        tiles = TileValues(values_);
        forEachOn(node.active, [&](std::size_t tile) {
            file_.active_tiles_.expand(openvdb::CoordBBox::createCube(node.originOf(tile), 1 << node.child_log2));
        });
    }

    LeafFile& file_;
    const VdbCursor& cursor_;
    std::vector<float> values_;            // of the node that is read
    std::vector<std::string_view> masks_;  // of the leaves below each lower node
};

std::shared_ptr<const LeafFile> LeafFile::open(InputFile input, const std::string& name,
                                               const openvdb::MetaMap& metadata) {
    const std::shared_ptr<LeafFile> file(new LeafFile(std::move(input)));
    try {
        VdbCursor heads_cursor(file->file_, file->where_);
        const VdbHeads heads = walkVdbHeads(heads_cursor);
        const auto grid = std::find_if(heads.grids.begin(), heads.grids.end(), [&name](const VdbGrid& g) {
            return openvdb::io::GridDescriptor::stripSuffix(g.name) == name;
        });
        if (grid == heads.grids.end() || grid->type != openvdb::FloatGrid::gridType() || !grid->parent.empty())
            return nullptr;
        file->head_ = openvdb::FloatGrid::create();
        file->head_->setTransform(transformOf(heads, *grid));
        file->head_->insertMeta(metadata);
        file->name_ = file->head_->getName();
        file->format_ = *valueFormatOf(*grid);
        VdbCursor cursor = file->cursorAt(grid->tree);
        const auto first = static_cast<std::uint64_t>(grid->leaves);
        const auto end = static_cast<std::uint64_t>(grid->end);
        if (end > file->file_.size() || first > end) cursor.fail("places of other leaves");
        // Each leaf has two masks in the file: a damaged list can't ask for more memory than that.
        file->leaves_.reserve(static_cast<std::size_t>(
            std::min<std::uint64_t>(grid->listed.value_or(0), file->file_.size() / (2 * kLeafMaskBytes))));
        TreeReader reader(*file, cursor);
        walkVdbTree(cursor, file->format_, reader);
        if (cursor.offset() != first) cursor.fail("places of other leaves");
        file->placeLeaves(first, end, *grid, reader.masks());
    } catch (const InputError&) {
        throw;
    } catch (const std::exception& error) {
        // OpenVDB throws its own kinds, and std::bad_alloc for the absurd counts of a damaged file.
        throw InputError(
            fmt::format("{}: is not a readable .vdb file ({}); is it cut short?", file->where_, error.what()));
    }
    return file;
}

VdbCursor LeafFile::cursorAt(std::uint64_t offset) const {
    VdbCursor cursor(file_, where_, &name_);
    cursor.moveTo(static_cast<std::int64_t>(offset));
    return cursor;
}

void LeafFile::placeLeaves(std::uint64_t first, std::uint64_t end, const VdbGrid& grid,
                           const std::vector<std::string_view>& masks) {
    VdbCursor cursor = cursorAt(first);
    std::optional<LeafPlaces> places = listedLeafPlaces(cursor, grid, format_, masks);
    if (!places) {
        places = walkLeafPlaces(cursor, format_, masks);
        if (cursor.offset() != end) cursor.fail("places of other leaves");
    }
    for (std::size_t n = 0; n < leaves_.size(); ++n) leaves_[n].offset = (*places)[n];
}

const float* LeafFile::samples(std::size_t leaf, float* scratch) const {
    VdbCursor cursor = cursorAt(leaves_[leaf].offset);
    const std::string_view active = cursor.take(kLeafMaskBytes);
    const VdbValues values = walkVdbValues(cursor, format_, active);
    unpackVdbValues(cursor, values, format_, active, background(), scratch);
    return scratch;
}

std::string_view LeafFile::activeOf(const Leaf& leaf) const { return cursorAt(leaf.offset).take(kLeafMaskBytes); }

float LeafFile::tile(const openvdb::Coord& at) const {
    const auto inNode = [&at](int log2_edge, int child_log2) {
        const int last = (1 << log2_edge) - 1;
        const auto along = [&](int axis) { return static_cast<std::size_t>(at[axis] >> child_log2 & last); };
        return along(0) << (2 * log2_edge) | along(1) << log2_edge | along(2);
    };
    const auto originOf = [&at](int log2) {
        const int mask = ~((1 << log2) - 1);
        return openvdb::Coord(at[0] & mask, at[1] & mask, at[2] & mask);
    };
    constexpr int kLowerSpan = kLowerLog2 + kLeafLog2;
    constexpr int kUpperSpan = kUpperLog2 + kLowerSpan;
    if (const auto lower = lower_.find(originOf(kLowerSpan)); lower != lower_.end())
        return lower->second[inNode(kLowerLog2, kLeafLog2)];
    if (const auto upper = upper_.find(originOf(kUpperSpan)); upper != upper_.end())
        return upper->second[inNode(kUpperLog2, kLowerSpan)];
    const auto root = root_tiles_.find(originOf(kUpperSpan));
    return root != root_tiles_.end() ? root->second : background();
}

openvdb::CoordBBox LeafFile::activeBox() const {
    openvdb::CoordBBox box = active_tiles_;
    for (const Leaf& leaf : leaves_) {
        const openvdb::CoordBBox all = openvdb::CoordBBox::createCube(leaf.origin, kLeafEdge);
        if (box.isInside(all)) continue;
        forEachOn(activeOf(leaf), [&](std::size_t voxel) {
            const auto along = [&](int log2) { return static_cast<int>(voxel >> log2 & 7); };
            box.expand(leaf.origin.offsetBy(along(6), along(3), along(0)));
        });
    }
    return box;
}

std::uint64_t LeafFile::activeVoxelCount() const {
    if (const auto said = head_->getMetadata<openvdb::Int64Metadata>(openvdb::GridBase::META_FILE_VOXEL_COUNT);
        said && said->value() >= 0)
        return static_cast<std::uint64_t>(said->value());
    std::uint64_t count = 0;
    for (const Leaf& leaf : leaves_) count += countOn(activeOf(leaf));
    return count;
}

}  // namespace stratum::march
