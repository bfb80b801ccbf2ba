#include "export/parts/part_file.h"

#include "base/byte_cursor.h"
#include "base/checksum.h"
#include "base/error.h"
#include "base/input_file.h"
#include "base/vdb_magic.h"
#include "export/parts/checksum.h"
#include "export/parts/view_stream.h"

#include <fmt/format.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>

#include <exception>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace stratum::exporter {
namespace {

using openvdb::GridBase;

class HeadCursor : public ByteCursor<HeadCursor> {
public:
    using ByteCursor::ByteCursor;
    explicit HeadCursor(const InputFile& input) : ByteCursor(input.unread()), input_(&input) {}
    void load(std::size_t offset, std::size_t count) const {
        if (input_ != nullptr) input_->load(offset, count);
    }
    [[noreturn]] void endsEarly() const { throw std::runtime_error("it ends early"); }
    std::string_view text() { return take(read<std::uint32_t>()); }

private:
    const InputFile* input_ = nullptr;
};

// Where the head and the leaves of its only grid are, before anything else is believed.
GridPlaces placesIn(const InputFile& input) {
    const std::string_view bytes = input.unread();
    GridPlaces places;
    places.head = VdbArchive(0).header(1, {}).size();
    HeadCursor cursor(input);
    cursor.take(places.head);
    for (int text = 0; text < 3; ++text) cursor.text();  // name, type, parent
    (void)cursor.read<std::int64_t>();
    places.leaves = cursor.read<std::uint64_t>();
    places.end = cursor.read<std::uint64_t>();
    if (places.leaves < cursor.offset() || places.leaves > places.end || places.end != bytes.size())
        throw std::runtime_error("it is cut short");
    input.load(0, places.leaves);
    const std::string_view head = bytes.substr(places.head, places.leaves - places.head);
    if (bytes.substr(0, places.head) != VdbArchive(0).header(1, identityOfPart(head)))
        throw std::runtime_error("the checksum of its head is wrong");
    return places;
}

bool saysPart(const InputFile& input) {
    constexpr std::string_view kWord = "shard_scene";
    // It is in the head; more and more is read until it is found.
    for (std::size_t seen = 1 << 18;; seen *= 4) {
        const std::string_view bytes = input.first(seen);
        if (!bytes.starts_with(kVdbMagic)) return false;
        if (bytes.find(kWord) != std::string_view::npos) return true;
        if (bytes.size() == input.size()) return false;
    }
}

// How many leaves the list has: OpenVDB does not say it, and reads behind its end.
std::size_t listedIn(std::string_view head, std::uint64_t metadata) {
    HeadCursor cursor(head);
    cursor.take(metadata);
    for (auto rest = cursor.read<std::uint32_t>(); rest > 0; --rest) {
        const std::string_view name = cursor.text();
        cursor.text();  // its type
        const std::string_view value = cursor.text();
        if (name == GridBase::META_FILE_DELAYED_LOAD && !value.empty()) return HeadCursor(value).read<std::uint32_t>();
    }
    return 0;
}

void readGrid(std::string_view bytes, PartFile& file) {
    ViewStream stream(bytes);
    stream.seekg(static_cast<std::streamoff>(file.places.head));
    openvdb::io::setCurrentVersion(stream);
    openvdb::io::GridDescriptor descriptor;
    (void)descriptor.read(stream);
    stream.read(reinterpret_cast<char*>(&file.format.compression), sizeof file.format.compression);
    file.format.half = descriptor.saveFloatAsHalf();
    file.listed = listedIn(bytes.substr(0, file.places.leaves), static_cast<std::uint64_t>(stream.tellg()));
    openvdb::MetaMap metadata;
    metadata.readMeta(stream);
    const auto transform = openvdb::math::Transform::createLinearTransform();
    transform->read(stream);
    file.places.topology = static_cast<std::uint64_t>(stream.tellg());
    struct {
        std::int32_t buffers;
        float background;
    } tree{};
    stream.read(reinterpret_cast<char*>(&tree), sizeof tree);
    if (!stream) throw std::runtime_error("it ends early");

    file.part = takePart(metadata);
    file.list = openvdb::DynamicPtrCast<openvdb::io::DelayedLoadMetadata>(metadata[GridBase::META_FILE_DELAYED_LOAD]);
    file.statistics.active_voxels =
        static_cast<std::size_t>(metadata.metaValue<openvdb::Int64>(GridBase::META_FILE_VOXEL_COUNT));
    file.statistics.active_box = {openvdb::Coord(metadata.metaValue<openvdb::Vec3i>(GridBase::META_FILE_BBOX_MIN)),
                                  openvdb::Coord(metadata.metaValue<openvdb::Vec3i>(GridBase::META_FILE_BBOX_MAX))};
    for (const char* own : {GridBase::META_FILE_DELAYED_LOAD, GridBase::META_FILE_VOXEL_COUNT,
                            GridBase::META_FILE_BBOX_MIN, GridBase::META_FILE_BBOX_MAX, GridBase::META_FILE_MEM_BYTES})
        metadata.removeMeta(own);
    file.grid = openvdb::FloatGrid::create(tree.background);
    file.grid->clearMetadata();
    file.grid->insertMeta(metadata);
    file.grid->setTransform(transform);
}

}  // namespace

std::string damageOf(const std::filesystem::path& path, std::string_view why) {
    return fmt::format("{}: is damaged ({}); make this shard again", path.string(), why);
}

PartFile readPartFile(const std::filesystem::path& path) {
    openvdb::initialize();
    const InputFile input(path);
    if (!saysPart(input))
        throw InputError(
            fmt::format("{}: is no part of a print; name those that gcode2vdb --shard wrote", path.string()));
    try {
        PartFile file;
        file.path = path;
        file.places = placesIn(input);
        readGrid(input.unread(), file);
        return file;
    } catch (const std::exception& error) {
        throw InputError(damageOf(path, error.what()));
    }
}

std::vector<LowerNode> nodesOf(const PartFile& file) {
    const InputFile input(file.path);
    if (input.size() < file.places.leaves) throw InputError(damageOf(file.path, "it is cut short"));
    input.load(0, file.places.leaves);
    ViewStream stream(input.unread().substr(0, file.places.leaves));
    stream.seekg(static_cast<std::streamoff>(file.places.topology));
    openvdb::io::setCurrentVersion(stream);
    openvdb::io::setDataCompression(stream, file.format.compression);
    openvdb::FloatTree tree;
    tree.readTopology(stream, file.format.half);
    std::vector<LowerNode> nodes;
    std::vector<LeafMask> masks;
    std::size_t leaves = 0;
    for (auto upper = tree.root().cbeginChildOn(); upper; ++upper)
        for (auto lower = upper->cbeginChildOn(); lower; ++lower) {
            LowerNode& node = nodes.emplace_back();
            node.origin = lower->origin();
            node.children = lower->getChildMask();
            for (auto tile = lower->cbeginChildOff(); tile; ++tile)
                if (*tile < 0) node.inside.setOn(tile.pos());
            masks.clear();
            for (auto leaf = lower->cbeginChildOn(); leaf; ++leaf) masks.push_back(leaf->getValueMask());
            node.leaves = PackedMasks(masks);
            if (nodes.size() > file.part.signs.size())
                throw InputError(damageOf(file.path, "it has more nodes than signs"));
            node.ends = file.part.signs[nodes.size() - 1];
            leaves += masks.size();
        }
    if (leaves != file.listed) throw InputError(damageOf(file.path, "its list is of other leaves"));
    return nodes;
}

PackedLeaf leafOf(const PartFile& file, std::size_t n) {
    if (!file.list) throw InputError(damageOf(file.path, "it has no list of its leaves"));
    return {file.list->getMask(n),
            file.format.sized() ? static_cast<std::uint32_t>(file.list->getCompressedSize(n)) : 0};
}

bool isPartOfPrint(const std::filesystem::path& path, const std::string& version, const std::string& scene,
                   const Shard& shard) {
    try {
        const PartFile file = readPartFile(path);
        if (file.part.version != version || file.part.scene != scene || file.part.shard != shard) return false;
        const InputFile input(path);
        return checksumOf(input.bytes().substr(file.places.leaves)) == file.part.checksum;
    } catch (const InputError&) {
        return false;  // missing or damaged: it is made again
    }
}

}  // namespace stratum::exporter
