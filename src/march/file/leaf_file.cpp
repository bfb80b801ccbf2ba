#include "march/file/leaf_file.h"

#include "base/byte_cursor.h"
#include "base/error.h"

#include <blosc.h>
#include <fmt/format.h>
#include <openvdb/io/Archive.h>
#include <openvdb/io/DelayedLoadMetadata.h>
#include <openvdb/io/GridDescriptor.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <optional>
#include <type_traits>

namespace stratum::march {
namespace {

constexpr std::size_t kLeafWords = LeafSource::kLeafSamples / 64;
constexpr int kUpperLog2 = 5;  // of children a side, in the nodes below the root
constexpr int kLowerLog2 = 4;  // and in those below them, whose children are leaves
constexpr int kLeafLog2 = 3;

// io::readCompressedValues(): what is said of the inactive values, in place of them.
enum Inactive : std::int8_t {
    kBackground,
    kMinusBackground,
    kOneValue,
    kMaskOfBackgrounds,
    kMaskAndOneValue,
    kMaskAndTwoValues,
    kAllStored
};

bool hasMask(std::int8_t kind) {
    return kind == kMaskOfBackgrounds || kind == kMaskAndOneValue || kind == kMaskAndTwoValues;
}
std::size_t valuesOf(std::int8_t kind) {
    if (kind == kMaskAndTwoValues) return 2;
    return kind == kOneValue || kind == kMaskAndOneValue ? 1 : 0;
}

std::size_t countOn(const std::uint64_t* mask, std::size_t count) {
    std::size_t on = 0;
    for (std::size_t n = 0; n < count / 64; ++n) on += static_cast<std::size_t>(std::popcount(mask[n]));
    return on;
}

// What a .vdb says before the tree of a grid.
struct GridHead {
    openvdb::FloatGrid::Ptr grid;
    bool blosc = false, active_only = false;
    std::uint64_t tree = 0, leaves = 0, end = 0;  // places in the file
    // OpenVDB lists the sizes beside compressed grids, so that nobody has to look at every leaf.
    openvdb::io::DelayedLoadMetadata sizes;
    bool has_sizes = false;
};

// OpenVDB reads its own heads.
class HeadReader : public openvdb::io::Archive {
public:
    HeadReader() = default;
    openvdb::SharedPtr<openvdb::io::Archive> copy() const override { return nullptr; }

    // MetaMap::readMeta(), of all that OpenVDB hands on but the sizes of the leaves, which it keeps to itself.
    static void readSizes(std::istream& in, openvdb::io::DelayedLoadMetadata& sizes, bool& has_sizes) {
        const auto length = [&in] {
            std::uint32_t bytes = 0;
            in.read(reinterpret_cast<char*>(&bytes), sizeof bytes);
            return bytes;
        };
        constexpr std::string_view kName = "file_delayed_load";
        for (std::uint32_t rest = length(); rest > 0; --rest) {
            const std::uint32_t bytes = length();
            std::string name(bytes == kName.size() ? bytes : 0, ' ');
            if (name.empty())
                in.seekg(bytes, std::ios::cur);
            else
                in.read(name.data(), bytes);
            in.seekg(length(), std::ios::cur);  // its type
            if (name == kName) {
                sizes.read(in);
                has_sizes = true;
            } else {
                in.seekg(length(), std::ios::cur);
            }
        }
    }

    std::optional<GridHead> read(std::istream& in, const std::string& name) {
        namespace io = openvdb::io;
        auto metadata = openvdb::SharedPtr<io::StreamMetadata>(new io::StreamMetadata);
        io::setStreamMetadataPtr(in, metadata, /*transfer=*/false);
        readHeader(in);
        setFormatVersion(in);
        setLibraryVersion(in);
        setDataCompression(in);
        if (!inputHasGridOffsets() || io::getFormatVersion(in) < openvdb::OPENVDB_FILE_VERSION_NODE_MASK_COMPRESSION)
            return std::nullopt;
        openvdb::MetaMap().readMeta(in);
        const std::int32_t grids = readGridCount(in);
        for (std::int32_t n = 0; n < grids; ++n) {
            io::GridDescriptor found;
            const openvdb::GridBase::Ptr grid = found.read(in);
            if (io::GridDescriptor::stripSuffix(found.gridName()) != name) {
                found.seekToEnd(in);
                continue;
            }
            GridHead head;
            head.grid = openvdb::gridPtrCast<openvdb::FloatGrid>(grid);
            if (!head.grid || found.isInstance() || found.saveFloatAsHalf()) return std::nullopt;
            found.seekToGrid(in);
            readGridCompression(in);
            const std::uint32_t compression = io::getDataCompression(in);
            if ((compression & io::COMPRESS_ZIP) != 0) return std::nullopt;
            head.blosc = (compression & io::COMPRESS_BLOSC) != 0;
            head.active_only = (compression & io::COMPRESS_ACTIVE_MASK) != 0;
            readSizes(in, head.sizes, head.has_sizes);
            head.grid->readTransform(in);
            head.tree = static_cast<std::uint64_t>(in.tellg());
            head.leaves = static_cast<std::uint64_t>(found.getBlockPos());
            head.end = static_cast<std::uint64_t>(found.getEndPos());
            return head;
        }
        return std::nullopt;
    }
};

}  // namespace

class LeafFile::Cursor : public ByteCursor<Cursor> {
public:
    Cursor(const LeafFile& file, std::uint64_t place) : ByteCursor(file.file_.bytes()), file_(file) {
        place_ = static_cast<std::size_t>(place);
        if (place > bytes_.size()) fail();
    }

    [[noreturn]] void fail() const {
        throw InputError(
            fmt::format("{}: is not a readable .vdb file (the grid {} is damaged about byte {}); is it cut "
                        "short?",
                        file_.file_.path().string(), file_.head_ ? file_.name() : "", place_));
    }
    [[noreturn]] void endsEarly() const { fail(); }

private:
    const LeafFile& file_;
};

struct LeafFile::Node {
    std::vector<std::uint64_t> children;  // a bit each
    std::vector<float> values;            // of tiles
};

std::shared_ptr<const LeafFile> LeafFile::open(const std::filesystem::path& path, const std::string& name,
                                               const openvdb::MetaMap& metadata) {
    const std::shared_ptr<LeafFile> file(new LeafFile(path));
    try {
        std::ifstream in(path, std::ios::binary);
        in.exceptions(std::ios::badbit | std::ios::failbit);
        const std::optional<GridHead> head = HeadReader().read(in, name);
        if (!head) return nullptr;
        file->head_ = head->grid;
        file->head_->insertMeta(metadata);
        file->blosc_ = head->blosc;
        file->active_only_ = head->active_only;
        Cursor cursor(*file, head->tree);
        if (head->end > file->file_.bytes().size() || head->leaves > head->end) cursor.fail();
        file->readTree(cursor);
        if (cursor.place() != head->leaves) cursor.fail();
        file->placeLeaves(head->leaves, head->end, head->has_sizes ? &head->sizes : nullptr);
    } catch (const InputError&) {
        throw;
    } catch (const std::exception& error) {
        // OpenVDB throws its own kinds, and std::bad_alloc for the absurd counts of a damaged file.
        throw InputError(
            fmt::format("{}: is not a readable .vdb file ({}); is it cut short?", path.string(), error.what()));
    }
    return file;
}

void LeafFile::readTree(Cursor& cursor) {
    (void)cursor.read<std::int32_t>();  // buffers; always one
    const auto background = cursor.read<float>();
    const auto grid = openvdb::FloatGrid::create(background);
    grid->setTransform(head_->transformPtr());
    grid->insertMeta(*head_);
    head_ = grid;
    const auto tiles = cursor.read<std::uint32_t>();
    const auto children = cursor.read<std::uint32_t>();
    const auto readCoord = [&cursor] {
        std::array<std::int32_t, 3> c{};
        cursor.read(c.data(), c.size());
        return openvdb::Coord(c[0], c[1], c[2]);
    };
    constexpr int kUpperEdge = 1 << (kUpperLog2 + kLowerLog2 + kLeafLog2);
    for (std::uint32_t n = 0; n < tiles; ++n) {
        const openvdb::Coord at = readCoord();
        root_tiles_[at] = cursor.read<float>();
        if (cursor.read<std::uint8_t>() != 0) active_tiles_.expand(openvdb::CoordBBox::createCube(at, kUpperEdge));
    }
    for (std::uint32_t n = 0; n < children; ++n) {
        const openvdb::Coord at = readCoord();
        Node upper;
        readNode<kUpperLog2>(cursor, at, upper, [&](const openvdb::Coord& lower_at) {
            Node lower;
            std::size_t leaves = 0;
            readNode<kLowerLog2>(cursor, lower_at, lower, [&](const openvdb::Coord& leaf) {
                leaves_.push_back({leaf, 0});
                ++leaves;
            });
            // Their masks of active voxels; they are stored once more beside the values.
            (void)cursor.take(leaves * kLeafWords * sizeof(std::uint64_t));
            lower_[lower_at] = std::move(lower.values);
        });
        upper_[at] = std::move(upper.values);
    }
}

// Calls `child` for each child, in the file's order.
template <int kLog2Edge, typename Child>
void LeafFile::readNode(Cursor& cursor, const openvdb::Coord& origin, Node& node, const Child& child) {
    constexpr std::size_t kCount = std::size_t{1} << (3 * kLog2Edge);
    constexpr int kChildLog2 = kLog2Edge == kLowerLog2 ? kLeafLog2 : kLowerLog2 + kLeafLog2;
    node.children.resize(kCount / 64);
    cursor.read(node.children.data(), node.children.size());
    std::vector<std::uint64_t> active(kCount / 64);
    cursor.read(active.data(), active.size());
    node.values.resize(kCount);
    readValues(cursor, active.data(), kCount, node.values.data());
    const auto placeOf = [&origin](std::size_t n) {
        constexpr std::size_t kLast = (std::size_t{1} << kLog2Edge) - 1;
        const auto along = [](std::size_t index) { return static_cast<int>(index & kLast) << kChildLog2; };
        return origin.offsetBy(along(n >> (2 * kLog2Edge)), along(n >> kLog2Edge), along(n));
    };
    for (std::size_t word = 0; word < kCount / 64; ++word) {
        for (std::uint64_t rest = active[word]; rest != 0; rest &= rest - 1)
            active_tiles_.expand(openvdb::CoordBBox::createCube(
                placeOf(64 * word + static_cast<std::size_t>(std::countr_zero(rest))), 1 << kChildLog2));
        for (std::uint64_t rest = node.children[word]; rest != 0; rest &= rest - 1)
            child(placeOf(64 * word + static_cast<std::size_t>(std::countr_zero(rest))));
    }
}

// io::readCompressedValues().
void LeafFile::readValues(Cursor& cursor, const std::uint64_t* active, std::size_t count, float* out) const {
    const auto kind = cursor.read<std::int8_t>();
    if (kind < kBackground || kind > kAllStored) cursor.fail();
    const float background = head_->background();
    float inactive[2] = {kind == kBackground ? background : -background, background};
    cursor.read(inactive, valuesOf(kind));
    std::array<std::uint64_t, (std::size_t{1} << (3 * kUpperLog2)) / 64> chosen;  // between the two
    if (hasMask(kind)) cursor.read(chosen.data(), count / 64);

    const bool expand = active_only_ && kind != kAllStored;
    const std::size_t stored = expand ? countOn(active, count) : count;
    std::array<float, LeafSource::kLeafSamples> near;
    std::vector<float> far;
    float* values = out;
    if (stored != count) {
        if (stored > near.size()) far.resize(stored);
        values = far.empty() ? near.data() : far.data();
    }
    const auto length = static_cast<std::int64_t>(stored * sizeof(float));
    const std::int64_t packed = blosc_ ? cursor.read<std::int64_t>() : -length;
    if (packed <= 0) {
        if (packed != -length) cursor.fail();
        cursor.read(values, stored);
    } else {
        const char* from = cursor.take(static_cast<std::uint64_t>(packed)).data();
        std::size_t validated = 0;
        if (blosc_cbuffer_validate(from, static_cast<std::size_t>(packed), &validated) != 0 ||
            validated != static_cast<std::size_t>(length) ||
            blosc_decompress_ctx(from, values, static_cast<std::size_t>(length), 1) != length)
            cursor.fail();
    }
    if (stored == count) return;
    const float* next = values;
    for (std::size_t word = 0; word < count / 64; ++word) {
        const std::uint64_t which = hasMask(kind) ? chosen[word] : 0;
        for (std::size_t row = 0; row < 64; row += 8) {
            const std::uint64_t on = active[word] >> row & 0xff;
            float* const to = out + 64 * word + row;
            if (on == 0xff) {
                std::memcpy(to, next, 8 * sizeof(float));
                next += 8;
                continue;
            }
            for (std::size_t bit = 0; bit < 8; ++bit) to[bit] = inactive[which >> (row + bit) & 1];
            for (std::uint64_t rest = on; rest != 0; rest &= rest - 1) to[std::countr_zero(rest)] = *next++;
        }
    }
}

// From the cursor to the next leaf, bytes.
std::uint64_t LeafFile::lengthOfLeaf(Cursor& cursor) const {
    const std::uint64_t first = cursor.place();
    std::array<std::uint64_t, kLeafWords> active;
    cursor.read(active.data(), active.size());
    const auto kind = cursor.read<std::int8_t>();
    (void)cursor.take(valuesOf(kind) * sizeof(float) + (hasMask(kind) ? sizeof active : 0));
    const bool expand = active_only_ && kind != kAllStored;
    const std::size_t stored = expand ? countOn(active.data(), kLeafSamples) : kLeafSamples;
    const auto length = static_cast<std::int64_t>(stored * sizeof(float));
    const std::int64_t packed = blosc_ ? cursor.read<std::int64_t>() : length;
    // Unsigned: the least of a damaged file has no opposite.
    (void)cursor.take(packed < 0 ? 0 - static_cast<std::uint64_t>(packed) : static_cast<std::uint64_t>(packed));
    return cursor.place() - first;
}

void LeafFile::placeLeaves(std::uint64_t first, std::uint64_t end, const openvdb::io::DelayedLoadMetadata* sizes) {
    if (sizes != nullptr && blosc_ && active_only_) {
        std::uint64_t place = first;
        for (std::size_t n = 0; n < leaves_.size(); ++n) {
            leaves_[n].place = place;
            const std::int8_t kind = sizes->getMask(n);
            const std::size_t mask = kLeafWords * sizeof(std::uint64_t);
            place += mask + 1 + valuesOf(kind) * sizeof(float) + (hasMask(kind) ? mask : 0) +
                     static_cast<std::uint64_t>(sizes->getCompressedSize(n));
        }
        if (place == end) return;
    }
    Cursor cursor(*this, first);
    for (Leaf& leaf : leaves_) {
        leaf.place = cursor.place();
        (void)lengthOfLeaf(cursor);
    }
    if (cursor.place() != end) cursor.fail();
}

const float* LeafFile::samples(std::size_t leaf, float* scratch) const {
    Cursor cursor(*this, leaves_[leaf].place);
    std::array<std::uint64_t, kLeafWords> active;
    cursor.read(active.data(), active.size());
    readValues(cursor, active.data(), kLeafSamples, scratch);
    return scratch;
}

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
        Cursor cursor(*this, leaf.place);
        std::array<std::uint64_t, kLeafWords> active;
        cursor.read(active.data(), active.size());
        for (std::size_t x = 0; x < active.size(); ++x)
            for (std::uint64_t rest = active[x]; rest != 0; rest &= rest - 1) {
                const int bit = std::countr_zero(rest);
                box.expand(leaf.origin.offsetBy(static_cast<int>(x), bit >> 3, bit & 7));
            }
    }
    return box;
}

std::uint64_t LeafFile::activeVoxelCount() const {
    if (const auto said = head_->getMetadata<openvdb::Int64Metadata>(openvdb::GridBase::META_FILE_VOXEL_COUNT);
        said && said->value() >= 0)
        return static_cast<std::uint64_t>(said->value());
    std::uint64_t count = 0;
    for (const Leaf& leaf : leaves_) {
        Cursor cursor(*this, leaf.place);
        std::array<std::uint64_t, kLeafWords> active;
        cursor.read(active.data(), active.size());
        count += countOn(active.data(), kLeafSamples);
    }
    return count;
}

}  // namespace stratum::march
