#include "gcode/container/bgcode.h"

#include "base/error.h"
#include "base/text.h"
#include "gcode/container/gzip.h"
#include "gcode/container/little_endian.h"
#include "gcode/container/unpack.h"
#include "gcode/text/number.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

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

BlockReader::BlockReader(std::string_view bytes, std::string_view name, Checksums checksums)
    : bytes_(bytes), name_(name), check_(checksums) {
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
    if (checksums_ && check_ == Checksums::check) {
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

namespace {

constexpr std::string_view kBlank = " \t\r";

// "986.61" or, by tool, "12.5, 0.00, 7": the sum. Absent if any part is no number.
std::optional<double> sumOf(std::string_view list) {
    double sum = 0;
    while (true) {
        const auto cut = std::min(list.find_first_of(",;"), list.size());
        const std::string_view part = trim(list.substr(0, cut), kBlank);
        const char* p = part.data();
        double value = 0;
        if (!parseNumber(p, part.data() + part.size(), value) || value < 0) return std::nullopt;
        sum += value;
        if (cut == list.size()) return sum;
        list.remove_prefix(cut + 1);
    }
}

}  // namespace

void readIniMetadata(std::string_view text, std::vector<std::pair<std::string, std::string>>& metadata) {
    while (!text.empty()) {
        const std::string_view line = takePiece(text, '\n');
        const auto equals = line.find('=');
        if (equals != std::string_view::npos)
            // The rest of a value behind a line end would be read as a command.
            metadata.emplace_back(onOneLine(trim(line.substr(0, equals), kBlank)),
                                  onOneLine(trim(line.substr(equals + 1), kBlank)));
    }
}

void appendMetadata(Program& program) {
    ByteBuffer& text = program.unpacked;
    if (!text.view().empty() && text.view().back() != '\n') text.append("\n");
    for (const auto& [key, value] : program.metadata) {
        if (key == "Producer") {
            text.append("; generated by ");
        } else {
            text.append("; ");
            text.append(key);
            text.append(" = ");
        }
        text.append(value);
        text.append("\n");
        if (key == "filament used [mm]") program.filament_mm = sumOf(value);
    }
    program.text = text.view();
}

namespace {

constexpr std::size_t kMostMetadata = std::size_t{4} << 20;  // slicers write 10 to 100 kB

enum GcodeEncoding : std::uint16_t { kPlainText, kMeatPack, kMeatPackWithComments };

// A file truncated between two blocks has no other fault. But PrusaSlicer writes progress as M73, and its last one,
// before the end script, is "M73 P100 R0". "" if it is there, or if there is no M73.
std::string findLostEnd(std::string_view text) {
    constexpr std::size_t kReach = std::size_t{1} << 20;  // marks come at every per cent or minute
    constexpr std::string_view kMark = "\nM73 P";
    const std::string_view tail = text.substr(text.size() - std::min(text.size(), kReach));
    const auto at = tail.rfind(kMark);
    if (at == std::string_view::npos) return {};
    const char* p = tail.data() + at + kMark.size();
    double percent = 0;
    if (!parseNumber(p, tail.data() + tail.size(), percent) || percent >= 100) return {};
    return fmt::format("its last progress mark, M73, says {:g} %", percent);
}

// The block with which the headers alone state more than `most` bytes, so that nothing is unpacked in vain. Damage is
// left to the reader that checks all: it tells of the first one.
std::optional<Block> statedBeyond(std::size_t most, std::string_view bytes, std::string_view name) {
    BlockReader headers(bytes, name, BlockReader::Checksums::skip);
    Block block;
    std::size_t stated = 0;
    try {
        while (headers.next(block)) {
            if (block.type != BlockType::thumbnail) stated += block.size;
            if (stated > most) return block;
        }
    } catch (const InputError&) {
        return std::nullopt;
    }
    return std::nullopt;
}

}  // namespace

bool isBgcode(std::string_view bytes) { return bytes.starts_with("GCDE"); }

Program openBgcode(std::string_view bytes, std::string_view name, const ContainerLimits& limits,
                   const Progress& progress) {
    const std::size_t most = limits.bytesFrom(bytes.size());
    Program program;
    program.format = "bgcode";
    BlockReader reader(bytes, name);
    const auto refuseLarge = [&](const Block& at) {
        reader.fail(
            at, fmt::format("the file unpacks to more than {} bytes from {}; this is no print", most, bytes.size()));
    };
    if (const std::optional<Block> beyond = statedBeyond(most, bytes, name)) refuseLarge(*beyond);
    Block block;
    ByteBuffer data;
    std::size_t gcode_blocks = 0;
    std::size_t metadata_bytes = 0;
    while (reader.next(block)) {
        if (progress) progress(static_cast<double>(block.offset) / static_cast<double>(bytes.size()));
        if (block.type == BlockType::thumbnail) continue;
        const bool gcode = block.type == BlockType::gcode;
        const bool packed = gcode && block.encoding != kPlainText;
        if (block.encoding > (gcode ? kMeatPackWithComments : 0))
            reader.fail(block,
                        fmt::format("encoding {}, expected {}; the file is damaged or newer: export it as ASCII G-code",
                                    block.encoding, gcode ? "0 to 2" : "0"));
        const std::size_t unpacked = block.size * (packed ? 2 : 1);  // MeatPack at most doubles
        if (unpacked > most || program.unpacked.size() + metadata_bytes > most - unpacked) refuseLarge(block);
        if (gcode && !packed) {
            reader.unpack(block, {program.unpacked.extend(block.size), block.size});
        } else {
            data.truncate(0);
            reader.unpack(block, {data.extend(block.size), block.size});
            if (packed) {
                const std::string_view problem = unpackMeatPack(data.view(), program.unpacked);
                if (!problem.empty()) reader.fail(block, fmt::format("{}; copy or export it again", problem));
            } else {
                metadata_bytes += data.size();
                if (metadata_bytes > kMostMetadata)
                    reader.fail(block, fmt::format("more than {} bytes of metadata; this is no print", kMostMetadata));
                readIniMetadata(data.view(), program.metadata);
            }
        }
        gcode_blocks += gcode ? 1 : 0;
    }
    if (gcode_blocks == 0)
        throw InputError(
            fmt::format("{}: binary G-code ends at byte {} without a G-code block; it is cut off: copy or "
                        "export it again",
                        name, bytes.size()));
    program.cut_short = findLostEnd(program.unpacked.view());
    appendMetadata(program);
    return program;
}

}  // namespace stratum::gcode
