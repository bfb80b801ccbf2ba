#include "march/file/leaf_file.h"

#include "base/error.h"

#include <blosc.h>
#include <fmt/format.h>
#include <openvdb/io/DelayedLoadMetadata.h>
#include <openvdb/io/GridDescriptor.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <sstream>
#include <type_traits>

namespace stratum::march {
namespace {

float floatOf(std::string_view bytes) {
    float value = 0;
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
}

openvdb::math::Transform::Ptr transformOf(const VdbHeads& heads, const VdbGrid& grid) {
    std::istringstream in{std::string(grid.transform)};
    in.exceptions(std::ios::badbit | std::ios::failbit);
    openvdb::io::setVersion(in, {}, heads.format);
    auto transform = openvdb::math::Transform::createLinearTransform();
    transform->read(in);
    return transform;
}

}  // namespace

// Takes from the upper levels what samples need.
class LeafFile::TreeReader final : public VdbTreeVisitor {
public:
    explicit TreeReader(LeafFile& file) : file_(file) {}

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
    void lower(const VdbNode& node, std::string_view /*leaf_masks*/) override {
        takeTiles(node, file_.lower_[node.origin]);
        forEachOn(node.children, [&](std::size_t leaf) { file_.leaves_.push_back({node.originOf(leaf), 0}); });
    }
    void takeTiles(const VdbNode& node, std::vector<float>& values) {
        values.resize(node.active.size() * 8);
        file_.expand(node.values, node.active, values.data());
        forEachOn(node.active, [&](std::size_t tile) {
            file_.active_tiles_.expand(openvdb::CoordBBox::createCube(node.originOf(tile), 1 << node.child_log2));
        });
    }

    LeafFile& file_;
};

std::shared_ptr<const LeafFile> LeafFile::open(const std::filesystem::path& path, const std::string& name,
                                               const openvdb::MetaMap& metadata) {
    const std::shared_ptr<LeafFile> file(new LeafFile(path));
    try {
        VdbCursor heads_cursor(file->file_.bytes(), file->where_);
        const VdbHeads heads = walkVdbHeads(heads_cursor);
        const auto grid = std::find_if(heads.grids.begin(), heads.grids.end(), [&name](const VdbGrid& g) {
            return openvdb::io::GridDescriptor::stripSuffix(g.name) == name;
        });
        if (grid == heads.grids.end() || grid->type != openvdb::FloatGrid::gridType() || !grid->parent.empty() ||
            grid->half || (grid->compression & kVdbZip) != 0)
            return nullptr;
        file->head_ = openvdb::FloatGrid::create();
        file->head_->setTransform(transformOf(heads, *grid));
        file->head_->insertMeta(metadata);
        file->name_ = file->head_->getName();
        file->format_.compression = grid->compression;
        VdbCursor cursor = file->cursorAt(grid->tree);
        const auto first = static_cast<std::uint64_t>(grid->leaves);
        const auto end = static_cast<std::uint64_t>(grid->end);
        if (end > file->file_.bytes().size() || first > end) cursor.fail("places of other leaves");
        TreeReader reader(*file);
        walkVdbTree(cursor, file->format_, reader);
        if (cursor.offset() != first) cursor.fail("places of other leaves");
        file->placeLeaves(first, end, *grid);
    } catch (const InputError&) {
        throw;
    } catch (const std::exception& error) {
        // OpenVDB throws its own kinds, and std::bad_alloc for the absurd counts of a damaged file.
        throw InputError(
            fmt::format("{}: is not a readable .vdb file ({}); is it cut short?", path.string(), error.what()));
    }
    return file;
}

VdbCursor LeafFile::cursorAt(std::uint64_t offset) const {
    VdbCursor cursor(file_.bytes(), where_, &name_);
    cursor.moveTo(static_cast<std::int64_t>(offset));
    return cursor;
}

// io::readCompressedValues(), of what was walked through.
void LeafFile::expand(const VdbValues& values, std::string_view active, float* out) const {
    const std::size_t count = active.size() * 8;
    const float background = head_->background();
    float inactive[2] = {values.kind == VdbValues::kBackground ? background : -background, background};
    std::memcpy(inactive, values.inactive.data(), values.inactive.size());
    std::array<float, LeafSource::kLeafSamples> near;
    std::vector<float> far;
    float* to = out;
    if (values.stored != count) {
        if (values.stored > near.size()) far.resize(values.stored);
        to = far.empty() ? near.data() : far.data();
    }
    if (!values.packed)
        std::memcpy(to, values.data.data(), values.data.size());
    else if (const auto length = static_cast<std::int64_t>(values.length);
             blosc_decompress_ctx(values.data.data(), to, values.length, 1) != length)
        cursorAt(static_cast<std::uint64_t>(values.data.data() - file_.bytes().data())).fail("packed data");
    if (values.stored == count) return;
    const float* next = to;
    for (std::size_t word = 0; word < count / 64; ++word) {
        const std::uint64_t mask = wordOf(active, word);
        const std::uint64_t which = values.chosen.empty() ? 0 : wordOf(values.chosen, word);
        for (std::size_t row = 0; row < 64; row += 8) {
            const std::uint64_t on = mask >> row & 0xff;
            float* const row_to = out + 64 * word + row;
            if (on == 0xff) {
                std::memcpy(row_to, next, 8 * sizeof(float));
                next += 8;
                continue;
            }
            for (std::size_t bit = 0; bit < 8; ++bit) row_to[bit] = inactive[which >> (row + bit) & 1];
            for (std::uint64_t rest = on; rest != 0; rest &= rest - 1) row_to[std::countr_zero(rest)] = *next++;
        }
    }
}

void LeafFile::placeLeaves(std::uint64_t first, std::uint64_t end, const VdbGrid& grid) {
    if (grid.listed && (grid.compression & kVdbBlosc) != 0 && (grid.compression & kVdbActiveOnly) != 0) {
        openvdb::io::DelayedLoadMetadata sizes;
        std::istringstream in{std::string(grid.sizes)};
        in.exceptions(std::ios::badbit | std::ios::failbit);
        sizes.read(in);
        std::uint64_t offset = first;
        for (std::size_t n = 0; n < leaves_.size(); ++n) {
            leaves_[n].offset = offset;
            const std::int8_t kind = sizes.getMask(n);
            offset += kLeafMaskBytes + 1 + VdbValues::inactiveOf(kind) * sizeof(float) +
                      (VdbValues::hasMask(kind) ? kLeafMaskBytes : 0) +
                      static_cast<std::uint64_t>(sizes.getCompressedSize(n));
        }
        if (offset == end) return;
    }
    VdbCursor cursor = cursorAt(first);
    for (Leaf& leaf : leaves_) {
        leaf.offset = cursor.offset();
        (void)walkVdbValues(cursor, format_, cursor.take(kLeafMaskBytes));
    }
    if (cursor.offset() != end) cursor.fail("places of other leaves");
}

const float* LeafFile::samples(std::size_t leaf, float* scratch) const {
    VdbCursor cursor = cursorAt(leaves_[leaf].offset);
    const std::string_view active = cursor.take(kLeafMaskBytes);
    expand(walkVdbValues(cursor, format_, active), active, scratch);
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
