#include "gcode/container/gx.h"

#include "base/error.h"
#include "gcode/container/little_endian.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace stratum::gcode {
namespace {

// The text must start where an image ends, or at once behind the header.
bool followsTheThumbnail(std::string_view bytes, std::size_t text, std::size_t bitmap) {
    if (text == bitmap || text == gx::kHeaderBytes) return true;
    if (bitmap + 6 <= text && bytes.substr(bitmap, 2) == "BM" && bitmap + littleEndian(bytes, bitmap + 2, 4) == text)
        return true;
    constexpr std::size_t kPngEnd = 8;  // "IEND" and its CRC
    return text >= kPngEnd && bytes.substr(text - kPngEnd, 4) == "IEND";
}

// Whether the bytes before `text` are also text: then the offset is wrong, and a part would be lost unnoticed.
bool cutsIntoText(std::string_view bytes, std::size_t text) {
    constexpr std::size_t kLook = 256;
    const std::string_view before = bytes.substr(text - std::min(text, kLook), std::min(text, kLook));
    const auto printable = [](char c) {
        return std::isprint(static_cast<unsigned char>(c)) != 0 || c == '\n' || c == '\r' || c == '\t';
    };
    // An image of a single gray level is also printable, but has no line ends.
    const std::string_view near = before.substr(before.size() - std::min<std::size_t>(before.size(), 16));
    return std::all_of(near.begin(), near.end(), printable) && before.find('\n') != std::string_view::npos;
}

}  // namespace

bool isGx(std::string_view bytes) { return bytes.starts_with("xgcode "); }

Program openGx(std::string_view bytes, std::string_view name) {
    if (bytes.size() < gx::kHeaderBytes)
        throw InputError(
            fmt::format("{}: the FlashPrint header needs {} bytes, but the file ends after {}; copy or export "
                        "it again",
                        name, gx::kHeaderBytes, bytes.size()));
    const std::size_t text = littleEndian(bytes, gx::kTextAt, 4);
    const std::size_t bitmap = littleEndian(bytes, gx::kBitmapAt, 4);
    if (text < gx::kHeaderBytes || text >= bytes.size())
        throw InputError(
            fmt::format("{}: byte {}: the FlashPrint header says that the text starts at byte {}, expected {} "
                        "to {}; the file is cut off or damaged: copy or export it again",
                        name, gx::kTextAt, text, gx::kHeaderBytes, bytes.size() - 1));
    if (!followsTheThumbnail(bytes, text, bitmap) && cutsIntoText(bytes, text))
        throw InputError(
            fmt::format("{}: byte {}: the FlashPrint header says that the text starts at byte {}, which is in "
                        "the midst of it; the file is damaged: copy or export it again",
                        name, gx::kTextAt, text));
    Program program;
    program.format = "gx";
    program.text = bytes.substr(text);
    const double filament =
        static_cast<double>(littleEndian(bytes, gx::kRightFilamentAt, 4)) + littleEndian(bytes, gx::kLeftFilamentAt, 4);
    if (filament > 0) program.filament_mm = filament;
    const auto seconds = static_cast<double>(littleEndian(bytes, gx::kSecondsAt, 4));
    if (seconds > 0) program.facts.stated.seconds = seconds;
    return program;
}

}  // namespace stratum::gcode
