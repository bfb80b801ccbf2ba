#include "export/parts/part_file.h"

#include "base/byte_cursor.h"
#include "base/checksum.h"
#include "base/error.h"
#include "base/mapped_file.h"
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
    [[noreturn]] void endsEarly() const { throw std::runtime_error("it ends early"); }
    std::string_view text() { return take(read<std::uint32_t>()); }
};

// Where the head and the leaves of its only grid are, before anything else is believed.
GridPlaces placesIn(std::string_view bytes) {
    GridPlaces places;
    places.head = VdbArchive(0).header(1, {}).size();
    HeadCursor cursor(bytes);
    cursor.take(places.head);
    for (int text = 0; text < 3; ++text) cursor.text();  // name, type, parent
    (void)cursor.read<std::int64_t>();
    places.leaves = cursor.read<std::uint64_t>();
    places.end = cursor.read<std::uint64_t>();
    if (places.leaves < cursor.offset() || places.leaves > places.end || places.end != bytes.size())
        throw std::runtime_error("it is cut short");
    const std::string_view head = bytes.substr(places.head, places.leaves - places.head);
    if (bytes.substr(0, places.head) != VdbArchive(0).header(1, identityOfPart(head)))
        throw std::runtime_error("the checksum of its head is wrong");
    return places;
}

bool saysPart(std::string_view bytes) {
    return bytes.starts_with(kVdbMagic) && bytes.find("shard_scene") != std::string_view::npos;
}

void readGrid(std::string_view bytes, PartFile& file) {
    ViewStream stream(bytes);
    stream.seekg(static_cast<std::streamoff>(file.places.head));
    openvdb::io::setCurrentVersion(stream);
    openvdb::io::GridDescriptor descriptor;
    (void)descriptor.read(stream);
    stream.read(reinterpret_cast<char*>(&file.format.compression), sizeof file.format.compression);
    file.format.half = descriptor.saveFloatAsHalf();
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
    const MappedFile mapped(path);
    if (!saysPart(mapped.bytes()))
        throw InputError(
            fmt::format("{}: is no part of a print; name those that gcode2vdb --shard wrote", path.string()));
    try {
        PartFile file;
        file.path = path;
        file.places = placesIn(mapped.bytes());
        readGrid(mapped.bytes(), file);
        return file;
    } catch (const std::exception& error) {
        throw InputError(damageOf(path, error.what()));
    }
}

std::vector<LowerNode> nodesOf(const PartFile& file) {
    const MappedFile mapped(file.path);
    ViewStream stream(mapped.bytes().substr(0, file.places.leaves));
    stream.seekg(static_cast<std::streamoff>(file.places.topology));
    openvdb::io::setCurrentVersion(stream);
    openvdb::io::setDataCompression(stream, file.format.compression);
    openvdb::FloatTree tree;
    tree.readTopology(stream, file.format.half);
    std::vector<LowerNode> nodes;
    std::vector<LeafMask> masks;
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
        }
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
        const MappedFile mapped(path, Access::sequential);
        return checksumOf(mapped.bytes().substr(file.places.leaves)) == file.part.checksum;
    } catch (const InputError&) {
        return false;  // missing or damaged: it is made again
    }
}

}  // namespace stratum::exporter
