#include "gcode/thumbnail/bgcode_thumbnails.h"

#include "base/checksum.h"
#include "gcode/container/bgcode_block.h"
#include "gcode/container/little_endian.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace stratum::gcode {
namespace {

constexpr std::size_t kHeader = 10;

std::string blockOf(const Thumbnail& thumbnail, bool checksum) {
    std::string block;
    appendLittleEndian(block, static_cast<std::uint32_t>(BlockType::thumbnail), 2);
    appendLittleEndian(block, static_cast<std::uint32_t>(BlockCompression::none), 2);
    appendLittleEndian(block, static_cast<std::uint32_t>(thumbnail.bytes.size()), 4);
    appendLittleEndian(block, static_cast<std::uint32_t>(thumbnail.size.coding), 2);  // 0 PNG, 1 JPG, 2 QOI
    appendLittleEndian(block, static_cast<std::uint32_t>(thumbnail.size.width), 2);
    appendLittleEndian(block, static_cast<std::uint32_t>(thumbnail.size.height), 2);
    block += thumbnail.bytes;
    if (checksum) appendLittleEndian(block, checksumOf(block), 4);
    return block;
}

}  // namespace

PatchedBytes withBgcodeThumbnails(std::string_view bytes, std::span<const Thumbnail> thumbnails,
                                  std::string_view name) {
    struct Place {
        std::size_t offset;
        BlockType type;
    };
    std::vector<Place> blocks;
    BlockReader reader(bytes, name);
    for (Block block; reader.next(block);) blocks.push_back({block.offset, block.type});
    blocks.push_back({bytes.size(), BlockType{0xffff}});

    std::optional<std::size_t> first;  // the thumbnail that is there
    std::size_t behind = kHeader;      // the metadata that stands before thumbnails
    for (std::size_t n = 0; n + 1 < blocks.size(); ++n) {
        if (blocks[n].type == BlockType::thumbnail && !first) first = blocks[n].offset;
        if (blocks[n].type == BlockType::file_metadata || blocks[n].type == BlockType::printer_metadata)
            behind = blocks[n + 1].offset;
    }
    const std::size_t place = first.value_or(behind);
    const bool checksums = littleEndian(bytes, 8, 2) != 0;

    PatchedBytes result;
    const auto insert = [&] {
        for (const Thumbnail& thumbnail : thumbnails) result.add(blockOf(thumbnail, checksums));
    };
    result.keep(bytes.substr(0, kHeader));
    for (std::size_t n = 0; n + 1 < blocks.size(); ++n) {
        if (blocks[n].offset == place) insert();
        if (blocks[n].type != BlockType::thumbnail)
            result.keep(bytes.substr(blocks[n].offset, blocks[n + 1].offset - blocks[n].offset));
    }
    if (place == bytes.size()) insert();
    return result;
}

}  // namespace stratum::gcode
