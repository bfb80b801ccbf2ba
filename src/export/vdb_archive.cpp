#include "export/vdb_archive.h"

#include "base/checksum.h"
#include "base/error.h"

#include <blosc.h>
#include <fmt/format.h>
#include <openvdb/io/DelayedLoadMetadata.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>
#include <openvdb/util/Name.h>

#include <limits>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace stratum::exporter {
namespace {

using openvdb::GridBase;

constexpr std::size_t kUuidAt = 21;     // behind magic number, three versions and a flag
constexpr std::size_t kUuidBytes = 36;  // 8-4-4-4-12 digits

std::string uuidOf(std::string_view contents) {
    const std::string digits = sha256Hex(contents);
    return fmt::format("{}-{}-{}-{}-{}", digits.substr(0, 8), digits.substr(8, 4), digits.substr(12, 4),
                       digits.substr(16, 4), digits.substr(20, 12));
}

// The head around the leaf list's bytes: before them, with their length, and after them.
struct HeadParts {
    std::string before, after;
};

HeadParts headAround(const LeafFormat& format, const GridBase& grid, const std::string& name, const GridPlaces& places,
                     std::uint32_t list_bytes) {
    std::ostringstream out(std::ios::binary);
    openvdb::io::GridDescriptor descriptor(name, grid.type(), grid.saveFloatAsHalf());
    descriptor.writeHeader(out);
    descriptor.setGridPos(static_cast<openvdb::Int64>(places.head) + static_cast<openvdb::Int64>(out.tellp()) +
                          3 * static_cast<openvdb::Int64>(sizeof(openvdb::Int64)));
    descriptor.setBlockPos(static_cast<openvdb::Int64>(places.leaves));
    descriptor.setEndPos(static_cast<openvdb::Int64>(places.end));
    descriptor.writeStreamPos(out);
    out.write(reinterpret_cast<const char*>(&format.compression), sizeof format.compression);
    // As MetaMap::writeMeta(), by name, with the list among them.
    const bool listed = list_bytes > 0;
    const auto count = static_cast<std::uint32_t>(grid.metaCount() + (listed ? 1 : 0));
    out.write(reinterpret_cast<const char*>(&count), sizeof count);
    HeadParts parts;
    bool done = !listed;
    const auto writeList = [&] {
        openvdb::writeString(out, GridBase::META_FILE_DELAYED_LOAD);
        openvdb::writeString(out, openvdb::io::DelayedLoadMetadata::staticTypeName());
        out.write(reinterpret_cast<const char*>(&list_bytes), sizeof list_bytes);
        parts.before = out.str();
        out.str({});
        done = true;
    };
    for (auto meta = grid.beginMeta(); meta != grid.endMeta(); ++meta) {
        if (!done && meta->first > GridBase::META_FILE_DELAYED_LOAD) writeList();
        openvdb::writeString(out, meta->first);
        openvdb::writeString(out, meta->second->typeName());
        meta->second->write(out);
    }
    if (!done) writeList();
    grid.writeTransform(out);
    parts.after = out.str();
    if (!listed) parts.before.swap(parts.after);
    return parts;
}

// OpenVDB (10, DelayedLoadMetadata.cc) reserves memory for a packed list by a float, which is too small for some long
// ones: then it refuses the file. It reads any list that is not packed.
constexpr std::size_t kMostPackedLeaves = std::size_t{1} << 24;

constexpr std::size_t kPlainBytes = sizeof(std::int8_t) + sizeof(std::int64_t);  // of a leaf

void append(std::string& bytes, std::uint32_t value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

// As DelayedLoadMetadata has its lists: bytes of Blosc behind their number, or 0 and the values as they are. It packs
// as if values had four bytes; by their own size zeros come together.
template <typename T>
void appendList(std::string& bytes, const std::vector<T>& values, bool packs) {
    constexpr int kLevel = 9;
    constexpr std::size_t kFilledUp = 128;  // shorter ones it fills up before it packs them
    const std::size_t plain = values.size() * sizeof(T);
    packs = packs && plain >= kFilledUp;
    std::vector<char> chunk(packs ? plain + BLOSC_MAX_OVERHEAD : 0);
    const int packed = packs ? blosc_compress_ctx(kLevel, BLOSC_SHUFFLE, sizeof(T), plain, values.data(), chunk.data(),
                                                  chunk.size(), BLOSC_LZ4_COMPNAME, 0, 1)
                             : 0;
    const bool smaller = packed > 0 && static_cast<std::size_t>(packed) < plain;
    append(bytes, smaller ? static_cast<std::uint32_t>(packed) : 0);
    bytes.append(smaller ? chunk.data() : reinterpret_cast<const char*>(values.data()),
                 smaller ? static_cast<std::size_t>(packed) : plain);
}

}  // namespace

std::string VdbArchive::header(std::size_t grids, const std::string& identity) const {
    std::ostringstream out(std::ios::binary);
    writeHeader(out, /*seekable=*/true);
    openvdb::MetaMap().writeMeta(out);
    const auto count = static_cast<std::int32_t>(grids);
    out.write(reinterpret_cast<const char*>(&count), sizeof count);
    std::string bytes = out.str();
    // OpenVDB takes a random one.
    bytes.replace(kUuidAt, kUuidBytes, uuidOf(identity));
    return bytes;
}

LeafFormat VdbArchive::formatOf(const GridBase& grid) const {
    std::ostringstream out(std::ios::binary);
    setGridCompression(out, grid);
    return {openvdb::io::getDataCompression(out), grid.saveFloatAsHalf()};
}

void LeafList::reserve(std::size_t leaves) {
    kinds_.reserve(leaves);
    if (format_.sized()) sizes_.reserve(leaves);
}

void LeafList::add(PackedLeaf leaf) {
    kinds_.push_back(leaf.kind);
    if (format_.sized()) sizes_.push_back(static_cast<std::uint16_t>(leaf.size));
}

std::string LeafList::bytes() const {
    if (kinds_.empty()) return {};
    if (kinds_.size() * kPlainBytes > std::numeric_limits<std::uint32_t>::max())
        throw OutputError(
            fmt::format("{} leaves are more than the .vdb format can list; choose a larger voxel", kinds_.size()));
    const bool packs = kinds_.size() <= kMostPackedLeaves;
    std::string bytes;
    append(bytes, static_cast<std::uint32_t>(kinds_.size()));
    appendList(bytes, kinds_, packs);
    if (format_.sized())
        appendList(bytes, std::vector<std::int64_t>(sizes_.begin(), sizes_.end()), packs);
    else
        append(bytes, std::numeric_limits<std::uint32_t>::max());  // no sizes
    return bytes;
}

std::size_t LeafList::mostBytes(std::size_t leaves) {
    // A count and two lengths; and of short lists Blosc's own head.
    constexpr std::size_t kFixed = 1024;
    if (leaves == 0) return 0;
    if (leaves > kMostPackedLeaves) return kFixed + leaves * kPlainBytes;
    // Sizes have 16 bits: six of eight planes of bytes are zeros, and two may be there as they are.
    return kFixed + leaves * (sizeof(std::int8_t) + sizeof(std::uint16_t)) + leaves / 8;
}

std::size_t headBytes(const VdbArchive& archive, const GridBase& grid, const std::string& name,
                      std::size_t list_bytes) {
    const HeadParts parts = headAround(archive.formatOf(grid), grid, name, {}, list_bytes > 0 ? 1 : 0);
    return parts.before.size() + list_bytes + parts.after.size();
}

void writeHead(PositionedFile& file, const VdbArchive& archive, const GridBase& grid, const std::string& name,
               const GridPlaces& places, std::string_view list) {
    const std::size_t listed = list.empty() ? 0 : 1;
    const std::size_t fixed = headBytes(archive, grid, name, listed) - listed;
    const std::uint64_t room = places.topology - places.head - fixed;
    if (room > std::numeric_limits<std::uint32_t>::max())
        throw OutputError("a grid of more than four thousand million bytes of leaf list can't be written");
    if (list.size() > room) throw std::logic_error("the leaf list is longer than the room for it");
    const HeadParts parts = headAround(archive.formatOf(grid), grid, name, places, static_cast<std::uint32_t>(room));
    file.write(places.head, parts.before);
    file.write(places.head + parts.before.size(), list);
    file.write(places.topology - parts.after.size(), parts.after);
}

std::string identityOf(const GridBase& grid, std::string_view list) {
    std::ostringstream out(std::ios::binary);
    grid.writeMeta(out);
    grid.writeTransform(out);
    return out.str().append(list);
}

void insertStatistics(GridBase& grid, const GridStatistics& statistics, const LeafFormat& format) {
    grid.insertMeta(GridBase::META_FILE_BBOX_MIN, openvdb::Vec3IMetadata(statistics.active_box.min().asVec3i()));
    grid.insertMeta(GridBase::META_FILE_BBOX_MAX, openvdb::Vec3IMetadata(statistics.active_box.max().asVec3i()));
    grid.insertMeta(GridBase::META_FILE_MEM_BYTES,
                    openvdb::Int64Metadata(static_cast<openvdb::Int64>(statistics.memory_bytes)));
    grid.insertMeta(GridBase::META_FILE_VOXEL_COUNT,
                    openvdb::Int64Metadata(static_cast<openvdb::Int64>(statistics.active_voxels)));
    grid.insertMeta(GridBase::META_FILE_COMPRESSION,
                    openvdb::StringMetadata(openvdb::io::compressionToString(format.compression)));
}

}  // namespace stratum::exporter
