#include "export/vdb_archive.h"

#include "base/checksum.h"
#include "base/error.h"

#include <fmt/format.h>
#include <openvdb/io/DelayedLoadMetadata.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>
#include <openvdb/util/Name.h>

#include <limits>
#include <sstream>
#include <string_view>

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

template <typename T>
void append(std::string& bytes, const T* values, std::size_t count) {
    bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
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
    if (kinds_.size() > kMostPackedLeaves) return plainBytes();
    openvdb::io::DelayedLoadMetadata list;
    list.resizeMask(kinds_.size());
    for (std::size_t n = 0; n < kinds_.size(); ++n) list.setMask(n, kinds_[n]);
    if (format_.sized()) {
        list.resizeCompressedSize(kinds_.size());
        for (std::size_t n = 0; n < kinds_.size(); ++n) list.setCompressedSize(n, sizes_[n]);
    }
    std::ostringstream out(std::ios::binary);
    list.write(out);
    return out.str().substr(sizeof(std::uint32_t));  // without its length
}

// As DelayedLoadMetadata::write() writes what it can't pack.
std::string LeafList::plainBytes() const {
    if (mostBytes(kinds_.size()) > std::numeric_limits<std::uint32_t>::max())
        throw OutputError(
            fmt::format("{} leaves are more than the .vdb format can list; choose a larger voxel", kinds_.size()));
    const auto count = static_cast<std::uint32_t>(kinds_.size());
    constexpr std::uint32_t kPlain = 0;
    constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    std::string bytes;
    bytes.reserve(mostBytes(kinds_.size()));
    append(bytes, &count, 1);
    append(bytes, &kPlain, 1);
    append(bytes, kinds_.data(), kinds_.size());
    append(bytes, format_.sized() ? &kPlain : &kNone, 1);
    for (const std::int64_t size : sizes_) append(bytes, &size, 1);
    return bytes;
}

std::size_t LeafList::mostBytes(std::size_t leaves) {
    // A count and two lengths; lists that cannot be packed are stored as they are.
    return leaves == 0 ? 0 : 3 * sizeof(std::uint32_t) + leaves * (sizeof(std::int8_t) + sizeof(std::int64_t));
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
