#include "gcode/container/sniff.h"

#include "base/error.h"

#include <fmt/format.h>

#include <cstdint>

namespace stratum::gcode {
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

bool isTextStl(std::string_view bytes) {
    const std::string_view start = bytes.substr(0, 4096);
    const auto first = start.find_first_not_of(" \t\r\n");
    return first != std::string_view::npos && start.substr(first).starts_with("solid") &&
           start.find("facet") != std::string_view::npos;
}

}  // namespace

void refuseOtherFormats(std::string_view bytes, std::string_view name) {
    const auto refuse = [name](std::string_view what) { throw InputError(fmt::format("{}: {}", name, what)); };
    if (bytes.empty()) refuse("is empty; slice the model again");
    if (bytes.starts_with("\x1f\x8b"sv))
        refuse("holds gzip-compressed data inside its container; unpack the outer one first");
    if (bytes.starts_with("PK\x03\x04"sv))
        refuse("holds a zip container inside its container; unpack the outer one first");
    if (bytes.starts_with("GCDE"sv))
        refuse("holds binary G-code (bgcode) inside its container; unpack the outer one first");
    if (isBinaryStl(bytes) || isTextStl(bytes)) refuse("is a STL model, not G-code; slice it first");
    if (bytes.starts_with("\xff\xfe"sv) || bytes.starts_with("\xfe\xff"sv))
        refuse("is UTF-16 text; save it as UTF-8 or ASCII");
    const auto zero = bytes.substr(0, std::size_t{1} << 16).find('\0');
    if (zero != std::string_view::npos)
        refuse(fmt::format("is binary (a zero byte at offset {}), not G-code; give the slicer's .gcode file", zero));
}

}  // namespace stratum::gcode
