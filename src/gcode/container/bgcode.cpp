#include "gcode/container/bgcode.h"

#include "base/error.h"
#include "gcode/container/bgcode_block.h"
#include "gcode/container/meatpack.h"
#include "gcode/container/metadata.h"
#include "gcode/text/number.h"

#include <fmt/format.h>

#include <algorithm>

namespace stratum::gcode {
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

}  // namespace

bool isBgcode(std::string_view bytes) { return bytes.starts_with("GCDE"); }

Program openBgcode(std::string_view bytes, std::string_view name, const ContainerLimits& limits,
                   const Progress& progress) {
    const std::size_t most = limits.bytesFrom(bytes.size());
    Program program;
    program.format = "bgcode";
    BlockReader reader(bytes, name);
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
        if (unpacked > most || program.unpacked.size() + metadata_bytes > most - unpacked)
            reader.fail(block, fmt::format("the file unpacks to more than {} bytes from {}; this is no print", most,
                                           bytes.size()));
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
