#include "gcode/container/gzip.h"

#include "base/error.h"
#include "gcode/container/little_endian.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace stratum::gcode {
namespace {

using namespace std::string_view_literals;

constexpr std::size_t kChunk = std::size_t{1} << 20;
constexpr std::size_t kReport = std::size_t{16} << 20;  // between two reports of progress

// Members may be padded with zeros (tapes do that); anything else behind them is damage, or a member that was one.
bool onlyZeros(std::string_view bytes) { return bytes.find_first_not_of('\0') == std::string_view::npos; }

}  // namespace

bool isGzip(std::string_view bytes) { return bytes.starts_with("\x1f\x8b"sv); }

Program openGzip(std::string_view bytes, std::string_view name, const ContainerLimits& limits,
                 const Progress& progress) {
    const std::size_t most = limits.bytesFrom(bytes.size());
    Program program;
    program.format = "gzip";
    // The last four bytes are the size of the last, usually the only, member: a hint that may be wrong.
    if (bytes.size() >= 18)
        program.unpacked.reserve(std::min({std::size_t{littleEndian(bytes, bytes.size() - 4, 4)} + 1, most,
                                           bytes.size() * std::size_t{kDeflateMostRatio}}));

    Inflater inflater(15 + 16);
    z_stream& stream = inflater.stream;
    const auto* const begin = reinterpret_cast<const Bytef*>(bytes.data());
    const auto* const end = begin + bytes.size();
    stream.next_in = const_cast<Bytef*>(begin);
    int member = 1;
    const auto fail = [&](std::string_view what) {
        throw InputError(fmt::format("{}: gzip member {} at byte {}: {}", name, member, stream.next_in - begin, what));
    };
    while (true) {
        // Fill what is reserved before growing.
        const std::size_t before = program.unpacked.size();
        const std::size_t room = std::clamp(program.unpacked.spare(), kChunk, kReport);
        stream.next_out = reinterpret_cast<Bytef*>(program.unpacked.extend(room));
        stream.avail_out = static_cast<uInt>(room);
        stream.avail_in = static_cast<uInt>(
            std::min(static_cast<std::size_t>(end - stream.next_in), std::size_t{std::numeric_limits<uInt>::max()}));
        const int status = inflate(&stream, Z_NO_FLUSH);
        program.unpacked.truncate(before + room - stream.avail_out);
        if (program.unpacked.size() > most)
            fail(fmt::format("unpacks to more than {} bytes from {}; this is no G-code (or unpack it with gunzip)",
                             most, bytes.size()));
        if (progress) progress(static_cast<double>(stream.next_in - begin) / static_cast<double>(bytes.size()));
        if (status == Z_STREAM_END) {
            const std::string_view rest = bytes.substr(static_cast<std::size_t>(stream.next_in - begin));
            if (onlyZeros(rest)) break;
            ++member;
            if (!isGzip(rest)) fail("expected another gzip member or the end of the file; copy or compress it again");
            inflateReset(&stream);
        } else if (status == Z_MEM_ERROR) {
            throw std::bad_alloc();
        } else if (status == Z_BUF_ERROR || (status == Z_OK && stream.next_in == end && stream.avail_out != 0)) {
            fail("the file ends here, in the middle of its data; copy or download it again");
        } else if (status != Z_OK) {
            fail(fmt::format("the compressed data is damaged ({}); copy or download it again", inflater.reason()));
        }
    }
    program.text = program.unpacked.view();
    return program;
}

}  // namespace stratum::gcode
