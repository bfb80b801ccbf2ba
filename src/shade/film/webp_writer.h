// WebP files of 8-bit RGB and RGBA pictures.
#pragma once

#include <cstdint>
#include <vector>

namespace stratum::shade {

inline constexpr int kWebpMostSide = 16383;  ///< pixels, of the format

/// Lossy; half of a JPEG's size. Its colours have half the resolution, found so that edges stay sharp ("sharp YUV").
/// @param pixels   3 or 4 * width * height bytes, sRGB or sRGB and alpha, row by row from the top; alpha is kept as it
/// is
/// @param quality  0 to 100
/// Throws std::invalid_argument for another number of bytes, std::runtime_error if libwebp can't.
std::vector<std::uint8_t> encodeWebp(int width, int height, const std::vector<std::uint8_t>& pixels, int quality);

}  // namespace stratum::shade
