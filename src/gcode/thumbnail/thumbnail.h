// Pictures that G-code files hold of themselves, for the screens of printers and the lists of programs.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::gcode {

/// How the picture is encoded. bmp is of .gx files alone.
enum class ThumbnailCoding { png, jpg, qoi, bmp };

/// "PNG", "JPG", "QOI", "BMP".
std::string_view codingName(ThumbnailCoding coding);

struct ThumbnailSize {
    int width = 0, height = 0;  ///< pixels, 1 to kMostThumbnailSide
    ThumbnailCoding coding = ThumbnailCoding::png;
    bool operator==(const ThumbnailSize&) const = default;
};

inline constexpr int kMostThumbnailSide = 4096;
inline constexpr std::size_t kMostThumbnails = 16;

struct Thumbnail {
    ThumbnailSize size;
    std::string bytes;  ///< the picture file
};

/// "300x300,16x16/QOI": as the setting `thumbnails` of PrusaSlicer 2.7 has them; PNG where nothing is said.
/// Throws UsageError.
std::vector<ThumbnailSize> parseThumbnails(std::string_view text);

// The size of a PNG, from its first chunk. Source: PNG Specification (Third Edition), 11.2.1 IHDR.

/// Nothing if the bytes begin no PNG, or one larger than kMostThumbnailSide.
std::optional<ThumbnailSize> pngSize(std::string_view bytes);

}  // namespace stratum::gcode
