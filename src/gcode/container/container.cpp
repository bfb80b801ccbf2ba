#include "gcode/container/container.h"

#include "base/error.h"
#include "gcode/container/bgcode.h"
#include "gcode/container/gx.h"
#include "gcode/container/gzip.h"
#include "gcode/container/zip_archive.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace stratum::gcode {

std::size_t ContainerLimits::bytesFrom(std::size_t packed) const {
    const std::size_t by_ratio =
        packed > most_bytes / std::max<std::size_t>(most_ratio, 1) ? most_bytes : packed * most_ratio;
    return std::min(most_bytes, std::max(any_ratio_bytes, by_ratio));
}

Program openContainer(std::string_view bytes, std::string_view name, std::optional<int> plate,
                      const ContainerLimits& limits, const Progress& progress) {
    Program program;
    if (isGzip(bytes)) {
        program = openGzip(bytes, name, limits, progress);
    } else if (isBgcode(bytes)) {
        program = openBgcode(bytes, name, limits, progress);
    } else if (isZip(bytes)) {
        program = openZip(bytes, name, plate, limits, progress);
    } else if (isGx(bytes)) {
        program = openGx(bytes, name);
    } else {
        program.format = "ascii";
        program.text = bytes;
    }
    if (plate && program.format != "3mf")
        throw UsageError(fmt::format("{}: --plate {}: only a .gcode.3mf has plates", name, *plate));
    return program;
}

namespace {

struct Descriptor {
    explicit Descriptor(const std::string& path) : fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
        if (fd < 0) throw InputError(fmt::format("{}: can't be opened ({})", path, std::strerror(errno)));
    }
    ~Descriptor() { ::close(fd); }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    const int fd;
};

}  // namespace

bool isStream(const std::string& path) {
    if (path == "-") return true;
    std::error_code ignored;
    return std::filesystem::is_fifo(path, ignored);
}

ByteBuffer readAll(int descriptor, std::string_view name, std::size_t most) {
    constexpr std::size_t kChunk = std::size_t{1} << 20;
    ByteBuffer buffer;
    while (true) {
        const std::size_t before = buffer.size();
        char* const start = buffer.extend(kChunk);
        const ssize_t got = ::read(descriptor, start, kChunk);
        buffer.truncate(before + (got > 0 ? static_cast<std::size_t>(got) : 0));
        if (got == 0) break;
        if (got < 0 && errno != EINTR)
            throw InputError(fmt::format("{}: can't be read ({}); give a file or a pipe", name, std::strerror(errno)));
        if (buffer.size() > most)
            throw InputError(fmt::format("{}: more than {} bytes; save it as a file and give that", name, most));
    }
    if (buffer.size() == 0) throw InputError(fmt::format("{}: is empty; pipe G-code into it", name));
    return buffer;
}

InputBytes::InputBytes(const std::string& path, Streams streams, std::size_t most)
    : name_(path == "-" ? "standard input" : path) {
    if (streams == Streams::read && path == "-") {
        buffer_ = readAll(STDIN_FILENO, name_, most);
    } else if (streams == Streams::read && isStream(path)) {
        const Descriptor stream(path);
        buffer_ = readAll(stream.fd, name_, most);
    } else {
        file_.emplace(path);
    }
}

namespace {

using namespace std::string_view_literals;

// A binary STL has no signature, but its size follows from its triangle count.
bool isBinaryStl(std::string_view bytes) {
    constexpr std::size_t kHeader = 80;
    if (bytes.size() < kHeader + 4) return false;
    std::uint64_t triangles = 0;
    for (std::size_t i = 4; i-- > 0;) triangles = triangles << 8 | static_cast<unsigned char>(bytes[kHeader + i]);
    return triangles > 0 && bytes.size() == kHeader + 4 + 50 * triangles;
}

bool isTextStl(std::string_view start) { return start.starts_with("solid") && start.find("facet") != start.npos; }

struct Signature {
    std::string_view start;
    std::string_view what;
};

// How files begin, and what to do instead.
constexpr std::array kSignatures{
    Signature{"\x1f\x8b"sv, "holds gzip-compressed data inside its container; unpack the outer one first"},
    Signature{"PK\x03\x04"sv, "holds a zip container inside its container; unpack the outer one first"},
    Signature{"GCDE"sv, "holds binary G-code (bgcode) inside its container; unpack the outer one first"},
    Signature{"\xff\xfe"sv, "is UTF-16 text; save it as UTF-8 or ASCII"},
    Signature{"\xfe\xff"sv, "is UTF-16 text; save it as UTF-8 or ASCII"},
    Signature{"\x89PNG"sv, "is a PNG picture, not G-code; give the slicer's .gcode file"},
    Signature{"\xff\xd8\xff"sv, "is a JPEG picture, not G-code; give the slicer's .gcode file"},
    Signature{"\x20\x42\x44\x56"sv, "is an OpenVDB file, not G-code; vdbtrace draws it, and vdbview shows it"},
    Signature{"NanoVDB"sv,
              "is a NanoVDB file, which is for other programs; give the .vdb or the .gcode that it was made of"},
    Signature{"\x76\x2f\x31\x01"sv, "is an OpenEXR picture, not G-code; give the slicer's .gcode file"},
    Signature{"#?RADIANCE"sv, "is a map of light, not G-code; it goes with --env"},
    Signature{"%PDF"sv, "is a PDF document, not G-code; give the slicer's .gcode file"},
    Signature{"Rar!"sv, "is a RAR archive; unpack it and give the .gcode file in it"},
    Signature{"7z\xbc\xaf"sv, "is a 7z archive; unpack it and give the .gcode file in it"},
    Signature{"BZh"sv, "is compressed by bzip2; unpack it first (bunzip2)"},
    Signature{"\xfd"
              "7zXZ"sv,
              "is compressed by xz; unpack it first (unxz)"},
    Signature{"\x28\xb5\x2f\xfd"sv, "is compressed by zstd; unpack it first (unzstd)"},
    Signature{"\x89HDF"sv, "is an HDF5 file, not G-code"},
    Signature{"version https://git-lfs"sv,
              "is a pointer of Git LFS, not the file itself; fetch that with 'git lfs pull'"},
    Signature{"3DPFNKG13WTW"sv,
              "is an XYZprinting .3w file, which only their printers read; export .gcode from the slicer instead"},
    Signature{"MLP\0"sv, "is a Markforged file, which only their printers read"},
    Signature{"\x12\x00\x00\x00"sv, "is a picture stack of a resin printer; this program reads what a nozzle lays"},
    Signature{"\x19\x00\xfd\x12"sv, "is a picture stack of a resin printer; this program reads what a nozzle lays"},
    Signature{"ANYCUBIC"sv, "is a picture stack of a resin printer; this program reads what a nozzle lays"},
    Signature{"ISO-10303"sv, "is a STEP model, not G-code; slice it first"},
    Signature{"<!DOCTYPE"sv, "is a web page, not G-code; download the file itself ('raw' or 'download')"},
    Signature{"<html"sv, "is a web page, not G-code; download the file itself ('raw' or 'download')"},
    Signature{"<svg"sv, "is an SVG drawing, not G-code"},
    Signature{"<?xml"sv, "is XML, not G-code; give the slicer's .gcode file"},
    Signature{"{\""sv, "is JSON, not G-code; give the slicer's .gcode file"},
    Signature{"{\n"sv, "is JSON, not G-code; give the slicer's .gcode file"},
    Signature{"0\nSECTION"sv, "is a DXF drawing, not G-code"},
    Signature{"mtllib "sv, "is an OBJ model, not G-code; slice it first"},
    Signature{"ply\n"sv, "is a PLY model, not G-code; slice it first"},
    Signature{"IN;"sv, "is a program of a pen plotter (HPGL), not G-code"},
    Signature{"PA;"sv, "is a program of a pen plotter (HPGL), not G-code"},
};

// .x3g and .s3g of MakerBot's and FlashForge's older printers: a stream of binary commands. The first is one that
// programs begin with: 136 (a tool's command), 137 (enable axes), 139 and 142 (moves), 144 and 145 (position, motor
// current), 149 (text on the display), 150 to 157 (progress, beeps, the start of a build).
bool isMakerBotStream(std::string_view bytes) {
    const auto first = static_cast<unsigned char>(bytes.front());
    return (first >= 0x83 && first <= 0x9d) && bytes.substr(0, 4096).find('\0') != std::string_view::npos;
}

}  // namespace

std::string_view withoutZeroTail(std::string_view bytes) {
    const auto last = bytes.find_last_not_of("\0\x1a"sv);
    return bytes.substr(0, last == std::string_view::npos ? 0 : last + 1);
}

void refuseOtherFormats(std::string_view bytes, std::string_view name) {
    const auto refuse = [name](std::string_view what) { throw InputError(fmt::format("{}: {}", name, what)); };
    if (bytes.empty()) refuse("is empty; slice the model again");
    if (withoutZeroTail(bytes).empty())
        refuse("holds only zero bytes; it was not copied whole: copy or export it again");
    for (const Signature& signature : kSignatures)
        if (bytes.starts_with(signature.start)) refuse(signature.what);
    const std::string_view start = bytes.substr(0, 4096);
    const auto first = start.find_first_not_of(" \t\r\n");
    if (isBinaryStl(bytes) || isTextStl(start.substr(std::min(first, start.size()))))
        refuse("is an STL model, not G-code; slice it first");
    const auto zero = bytes.substr(0, std::size_t{1} << 16).find('\0');
    if (zero == std::string_view::npos) return;
    if (isMakerBotStream(bytes))
        refuse(
            "is binary, as .x3g and .s3g files of MakerBot's and FlashForge's older printers are; export .gcode "
            "from the slicer instead");
    refuse(fmt::format("is binary (a zero byte at offset {}), not G-code; give the slicer's .gcode file", zero));
}

}  // namespace stratum::gcode
