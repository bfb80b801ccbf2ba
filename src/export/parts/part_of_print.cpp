#include "export/parts/part_of_print.h"

#include <stdexcept>

namespace stratum::exporter {
namespace {

using openvdb::MetaMap;

constexpr int kMostParts = 1'000'000;  // as parseShard() allows
constexpr const char* kIndex = "shard_index";
constexpr const char* kCount = "shard_count";
constexpr const char* kVersion = "shard_version";
constexpr const char* kScene = "shard_scene";
constexpr const char* kFirstBlock = "shard_first_block";
constexpr const char* kEndBlock = "shard_end_block";
constexpr const char* kLeaves = "shard_leaves";
constexpr const char* kLowerNodes = "shard_lower_nodes";
constexpr const char* kUpperNodes = "shard_print_upper_nodes";
constexpr const char* kSigns = "shard_signs";
constexpr const char* kChecksum = "shard_checksum";

template <typename T>
T take(MetaMap& metadata, const char* name) {
    T value = metadata.metaValue<T>(name);
    metadata.removeMeta(name);
    return value;
}

void insertNumber(MetaMap& metadata, const char* name, std::size_t value) {
    metadata.insertMeta(name, openvdb::Int64Metadata(static_cast<openvdb::Int64>(value)));
}

std::size_t takeNumber(MetaMap& metadata, const char* name) {
    return static_cast<std::size_t>(take<openvdb::Int64>(metadata, name));
}

}  // namespace

void insertPart(MetaMap& metadata, const PartOfPrint& part) {
    metadata.insertMeta(kIndex, openvdb::Int32Metadata(part.shard.index));
    metadata.insertMeta(kCount, openvdb::Int32Metadata(part.shard.count));
    metadata.insertMeta(kVersion, openvdb::StringMetadata(part.version));
    metadata.insertMeta(kScene, openvdb::StringMetadata(part.scene));
    insertNumber(metadata, kFirstBlock, part.blocks.first);
    insertNumber(metadata, kEndBlock, part.blocks.end);
    insertNumber(metadata, kLeaves, part.print.leaves);
    insertNumber(metadata, kLowerNodes, part.print.lower_nodes);
    insertNumber(metadata, kUpperNodes, part.print.upper_nodes);
    std::string digits;
    for (const EndSigns& ends : part.signs)
        digits += static_cast<char>('0' + (ends.first ? 1 : 0) + (ends.last ? 2 : 0));
    metadata.insertMeta(kSigns, openvdb::StringMetadata(digits));
    insertNumber(metadata, kChecksum, part.checksum);
}

PartOfPrint takePart(MetaMap& metadata) {
    PartOfPrint part;
    part.shard = {take<std::int32_t>(metadata, kIndex), take<std::int32_t>(metadata, kCount)};
    if (part.shard.index < 0 || part.shard.index >= part.shard.count || part.shard.count > kMostParts)
        throw std::runtime_error("its number is impossible");
    part.version = take<std::string>(metadata, kVersion);
    part.scene = take<std::string>(metadata, kScene);
    part.blocks = {takeNumber(metadata, kFirstBlock), takeNumber(metadata, kEndBlock)};
    part.print = {takeNumber(metadata, kLeaves), takeNumber(metadata, kLowerNodes), takeNumber(metadata, kUpperNodes)};
    for (const char digit : take<std::string>(metadata, kSigns))
        part.signs.push_back({((digit - '0') & 1) != 0, ((digit - '0') & 2) != 0});
    part.checksum = static_cast<std::uint32_t>(takeNumber(metadata, kChecksum));
    return part;
}

}  // namespace stratum::exporter
