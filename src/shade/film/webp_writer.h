// WebP files of 8-bit RGB pictures.
#pragma once

#include <cstdint>
#include <vector>

namespace stratum::shade {

inline constexpr int kWebpMostSide = 16383;  ///< pixels, of the format

/// Lossy; half of a JPEG's size. Its colours have half the resolution, found so that edges stay sharp ("sharp YUV").
/// @param rgb      3 * width * height bytes, sRGB, row by row from the top
/// @param quality  0 to 100
/// Throws std::invalid_argument for another number of bytes, std::runtime_error if libwebp can't.
std::vector<std::uint8_t> encodeWebp(int width, int height, const std::vector<std::uint8_t>& rgb, int quality);

}  // namespace stratum::shade
