#include "deposit/limits/printer_text.h"

#include "base/error.h"
#include "base/text.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <system_error>

namespace stratum::deposit {
namespace {

constexpr std::size_t kLongestQuote = 60;  // bytes of the file in a message

[[noreturn]] void refuse(gcode::Bounds bounds, std::string_view text, std::string_view place, std::string_view what) {
    throw InputError(
        fmt::format("{}: {} is {}; expected a number from {:g} to {:g}", place, what, text, bounds.least, bounds.most));
}

std::string quoted(std::string_view text) {
    const std::string line = onOneLine(text.substr(0, kLongestQuote));
    return line.empty() ? "empty" : fmt::format("'{}'", line);
}

// "PLACE: PATH WHAT", the path once.
[[noreturn]] void refuseFile(const std::string& path, const std::string& place, std::string_view what) {
    throw InputError(place == path ? fmt::format("{}: {}", path, what) : fmt::format("{}: {} {}", place, path, what));
}

}  // namespace

std::string readPrinterText(const std::string& path, const std::string& place) {
    std::error_code failed;
    if (std::filesystem::is_directory(path, failed)) refuseFile(path, place, "is a folder; give the printer's file");
    std::ifstream stream(path, std::ios::binary);
    std::string text(kLargestPrinterFile + 1, '\0');
    stream.read(text.data(), static_cast<std::streamsize>(text.size()));
    if (stream.bad() || (!stream && !stream.eof()))
        refuseFile(path, place, "can't be read; does it exist, and may you read it?");
    text.resize(static_cast<std::size_t>(stream.gcount()));
    if (text.size() > kLargestPrinterFile)
        refuseFile(
            path, place,
            fmt::format("has more than {} bytes, too many for a printer; is it the right file?", kLargestPrinterFile));
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";  // of editors on Windows
    if (text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
    return text;
}

std::string readIncludedText(const std::string& path, const std::string& place) {
    std::error_code failed;
    if (!std::filesystem::is_regular_file(path, failed))
        refuseFile(path, place, "is no file that can be read; does it exist?");
    return readPrinterText(path, place);
}

double numberIn(std::string_view text, gcode::Bounds bounds, std::string_view place, std::string_view what) {
    text = trim(text);
    const auto value = parsed<double>(text.substr(text.starts_with('+') ? 1 : 0));
    if (!value || !(*value >= bounds.least && *value <= bounds.most)) refuse(bounds, quoted(text), place, what);
    return *value;
}

void checkLimit(gcode::Limit limit, double value, std::string_view place, std::string_view what) {
    const gcode::Bounds bounds = gcode::boundsOf(limit);
    if (!(value >= bounds.least && value <= bounds.most)) refuse(bounds, fmt::format("{:g}", value), place, what);
}

}  // namespace stratum::deposit
