#include "gcode/container/bgcode_block.h"

#include "base/error.h"
#include "gcode/container/heatshrink.h"
#include "gcode/container/inflate.h"
#include "gcode/container/little_endian.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace stratum::gcode {
namespace {

constexpr std::size_t kFileHeader = 10;
constexpr std::size_t kMostBlocks = std::size_t{1} << 20;  // of at most 64 KiB each, as slicers write them

constexpr std::array<std::string_view, 6> kTypeNames{"file metadata",    "G-code",         "slicer metadata",
                                                     "printer metadata", "print metadata", "thumbnail"};

// Largest ratio of each compression, so that a damaged header can't request more memory than its data can fill.
std::size_t mostUnpacked(BlockCompression compression, std::size_t packed) {
    switch (compression) {
        case BlockCompression::none:
            return packed;
        case BlockCompression::deflate:
            return packed * kDeflateMostRatio;
        case BlockCompression::heatshrink_11_4:
        case BlockCompression::heatshrink_12_4:
            break;
    }
    return packed * 8;  // 16 bytes from 1 + 11 + 4 bits
}

// "" or what is wrong.
std::string_view inflateAll(std::string_view packed, std::span<char> out) {
    Inflater inflater(15);
    z_stream& stream = inflater.stream;
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
    stream.avail_in = static_cast<uInt>(packed.size());
    // zlib refuses a null pointer even for an output of 0 bytes.
    Bytef nothing = 0;
    stream.next_out = out.empty() ? &nothing : reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    const int status = inflate(&stream, Z_FINISH);
    if (status == Z_MEM_ERROR) throw std::bad_alloc();
    if (status != Z_STREAM_END && status != Z_OK && status != Z_BUF_ERROR) return "its deflate data is damaged";
    if (status != Z_STREAM_END || stream.avail_out != 0 || stream.avail_in != 0)
        return "its deflate data does not have the size that its header states";
    return {};
}

}  // namespace

BlockReader::BlockReader(std::string_view bytes, std::string_view name) : bytes_(bytes), name_(name) {
    const auto refuse = [name](const std::string& what) { throw InputError(fmt::format("{}: {}", name, what)); };
    if (bytes.size() < kFileHeader)
        refuse(
            fmt::format("the binary G-code ends after {} bytes, in its header; copy or export it again", bytes.size()));
    const std::uint32_t version = littleEndian(bytes, 4, 4);
    if (version != 1)
        refuse(
            fmt::format("is binary G-code of version {}; only version 1 is known: export it as ASCII G-code", version));
    const std::uint32_t checksum = littleEndian(bytes, 8, 2);
    if (checksum > 1)
        refuse(
            fmt::format("byte 8: checksum type {} of binary G-code; expected 0 (none) or 1 (CRC32): the file is "
                        "damaged, export it again",
                        checksum));
    checksums_ = checksum == 1;
    at_ = kFileHeader;
}

void BlockReader::fail(const Block& block, std::string_view what) const {
    const auto type = static_cast<std::size_t>(block.type);
    throw InputError(fmt::format("{}: block {} ({}) at byte {}: {}", name_, block.index,
                                 type < kTypeNames.size() ? kTypeNames[type] : "unknown", block.offset, what));
}

bool BlockReader::next(Block& block) {
    if (at_ == bytes_.size()) return false;
    block = {};
    block.type = BlockType{0xffff};  // unknown until its header is read
    block.index = ++count_;
    block.offset = at_;
    std::size_t left = bytes_.size() - at_;
    const auto cut = [&](std::size_t need) {
        fail(block, fmt::format("needs {} bytes, but the file ends after {}; it is cut off: copy or export it again",
                                need, left));
    };
    constexpr std::size_t kPlainHeader = 8;
    if (left < kPlainHeader) cut(kPlainHeader);
    const std::uint32_t type = littleEndian(bytes_, at_, 2);
    block.type = static_cast<BlockType>(type);
    const std::uint32_t compression = littleEndian(bytes_, at_ + 2, 2);
    block.compression = static_cast<BlockCompression>(compression);
    block.size = littleEndian(bytes_, at_ + 4, 4);
    if (type >= kTypeNames.size())
        fail(block, fmt::format("type {}, expected 0 to 5; the file is damaged: copy or export it again", type));
    if (compression > 3)
        fail(block,
             fmt::format("compression {}, expected 0 to 3; the file is damaged: copy or export it again", compression));
    if (count_ > kMostBlocks) fail(block, fmt::format("more than {} blocks; this is no print", kMostBlocks));

    const std::size_t header = compression == 0 ? kPlainHeader : kPlainHeader + 4;
    if (left < header) cut(header);
    const std::size_t stored = compression == 0 ? block.size : littleEndian(bytes_, at_ + 8, 4);
    const std::size_t parameters = block.type == BlockType::thumbnail ? 6 : 2;
    const std::size_t checked = header + parameters + stored;
    const std::size_t whole = checked + (checksums_ ? 4 : 0);
    if (left < whole) cut(whole);
    if (checksums_) {
        const auto* data = reinterpret_cast<const Bytef*>(bytes_.data() + at_);
        const auto found = static_cast<std::uint32_t>(crc32_z(0, data, checked));
        const std::uint32_t expected = littleEndian(bytes_, at_ + checked, 4);
        if (found != expected)
            fail(block, fmt::format("CRC32 {:08x}, expected {:08x}; the file is damaged: copy or export it again",
                                    found, expected));
    }
    block.encoding = static_cast<std::uint16_t>(littleEndian(bytes_, at_ + header, 2));
    block.data = bytes_.substr(at_ + header + parameters, stored);
    at_ += whole;
    if (block.type != BlockType::thumbnail && block.size > mostUnpacked(block.compression, stored))
        fail(block, fmt::format("{} bytes can't unpack to {}; the file is damaged: copy or export it again", stored,
                                block.size));
    return true;
}

void BlockReader::unpack(const Block& block, std::span<char> out) const {
    std::string_view problem;
    switch (block.compression) {
        case BlockCompression::none:
            std::copy(block.data.begin(), block.data.end(), out.begin());
            break;
        case BlockCompression::deflate:
            problem = inflateAll(block.data, out);
            break;
        case BlockCompression::heatshrink_11_4:
            problem = decodeHeatshrink(block.data, 11, 4, out);
            break;
        case BlockCompression::heatshrink_12_4:
            problem = decodeHeatshrink(block.data, 12, 4, out);
            break;
    }
    if (!problem.empty()) fail(block, fmt::format("{}; copy or export it again", problem));
}

}  // namespace stratum::gcode
