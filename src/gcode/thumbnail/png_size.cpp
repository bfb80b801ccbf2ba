#include "gcode/thumbnail/png_size.h"

#include "base/big_endian.h"

#include <cstdint>

namespace stratum::gcode {

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
