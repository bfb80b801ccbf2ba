#include "gcode/thumbnail/thumbnail.h"

#include "base/big_endian.h"
#include "base/error.h"
#include "base/names.h"
#include "base/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>

namespace stratum::gcode {
namespace {

constexpr std::array<std::string_view, 4> kCodingNames = {"PNG", "JPG", "QOI", "BMP"};

// A whole number of digits alone; -1 for other texts.
long numberOf(std::string_view text) {
    if (text.empty() || text.find_first_not_of("0123456789") != std::string_view::npos) return -1;
    return parsed<long>(text).value_or(kMostThumbnailSide + 1L);
}

ThumbnailCoding codingOf(std::string_view text, std::string_view whole) {
    const std::string upper = upperCase(std::string(text));
    if (upper == "JPEG") return ThumbnailCoding::jpg;
    constexpr std::array<std::string_view, 3> kAsked = {"PNG", "JPG", "QOI"};
    const auto* const found = std::find(kAsked.begin(), kAsked.end(), upper);
    if (found == kAsked.end())
        throw UsageError(fmt::format("--thumbnail {}: {} is no kind of picture; choose PNG, JPG or QOI{}", whole, text,
                                     didYouMean(upper, kAsked)));
    return static_cast<ThumbnailCoding>(found - kAsked.begin());
}

ThumbnailSize sizeOf(std::string_view word) {
    const std::string_view size = word.substr(0, word.find('/'));
    const std::size_t cross = size.find_first_of("xX");
    ThumbnailSize result;
    const long width = numberOf(size.substr(0, cross));
    const long height = cross == std::string_view::npos ? -1 : numberOf(size.substr(cross + 1));
    if (width < 0 || height < 0)
        throw UsageError(
            fmt::format("--thumbnail {}: expected WIDTHxHEIGHT in pixels, with /PNG, /JPG or /QOI behind it if it is "
                        "not PNG, and commas between several: 300x300,16x16/QOI",
                        word));
    if (width < 1 || height < 1 || width > kMostThumbnailSide || height > kMostThumbnailSide)
        throw UsageError(
            fmt::format("--thumbnail {}: each side must be from 1 to {} pixels", word, kMostThumbnailSide));
    result.width = static_cast<int>(width);
    result.height = static_cast<int>(height);
    if (size.size() < word.size()) result.coding = codingOf(word.substr(size.size() + 1), word);
    return result;
}

}  // namespace

std::string_view codingName(ThumbnailCoding coding) { return kCodingNames[static_cast<std::size_t>(coding)]; }

std::vector<ThumbnailSize> parseThumbnails(std::string_view text) {
    std::vector<ThumbnailSize> sizes;
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t comma = std::min(text.find(',', at), text.size());
        const ThumbnailSize size = sizeOf(trim(text.substr(at, comma - at), " \t"));
        if (std::find(sizes.begin(), sizes.end(), size) != sizes.end())
            throw UsageError(fmt::format("--thumbnail {}: {}x{}/{} is there twice; give each once", text, size.width,
                                         size.height, codingName(size.coding)));
        sizes.push_back(size);
        at = comma + 1;
    }
    if (sizes.size() > kMostThumbnails)
        throw UsageError(fmt::format("--thumbnail: {} pictures; give at most {}", sizes.size(), kMostThumbnails));
    return sizes;
}

std::optional<ThumbnailSize> pngSize(std::string_view bytes) {
    using namespace std::string_view_literals;
    constexpr std::string_view kStart = "\x89PNG\r\n\x1a\n\0\0\0\rIHDR"sv;
    if (!bytes.starts_with(kStart) || bytes.size() < kStart.size() + 8) return std::nullopt;
    const std::uint32_t width = bigEndian32(bytes, kStart.size());
    const std::uint32_t height = bigEndian32(bytes, kStart.size() + 4);
    if (width < 1 || height < 1 || width > kMostThumbnailSide || height > kMostThumbnailSide) return std::nullopt;
    return ThumbnailSize{static_cast<int>(width), static_cast<int>(height), ThumbnailCoding::png};
}

}  // namespace stratum::gcode
