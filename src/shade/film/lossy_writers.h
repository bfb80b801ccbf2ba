// Pictures as .jpg and .webp.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace stratum::shade {

// JPEG files of 8-bit RGB pictures.

inline constexpr int kJpegMostSide = 65500;  ///< pixels, of libjpeg

/// Colours are as sharp as brightness (4:4:4): prints have thin lines of other colours.
/// @param rgb       3 * width * height bytes, sRGB, row by row from the top
/// @param quality   1 to 100
/// @param metadata  a comment "KEYWORD: TEXT" each
/// Throws std::invalid_argument for another number of bytes, std::runtime_error if libjpeg can't.
std::vector<std::uint8_t> encodeJpeg(int width, int height, const std::vector<std::uint8_t>& rgb, int quality,
                                     const std::map<std::string, std::string>& metadata = {});

// WebP files of 8-bit RGB and RGBA pictures.

inline constexpr int kWebpMostSide = 16383;  ///< pixels, of the format

/// Lossy; half of a JPEG's size. Its colours have half the resolution, found so that edges stay sharp ("sharp YUV").
/// @param pixels   3 or 4 * width * height bytes, sRGB or sRGB and alpha, row by row from the top; alpha is kept as it
/// is
/// @param quality  0 to 100
/// Throws std::invalid_argument for another number of bytes, std::runtime_error if libwebp can't.
std::vector<std::uint8_t> encodeWebp(int width, int height, const std::vector<std::uint8_t>& pixels, int quality);

}  // namespace stratum::shade
