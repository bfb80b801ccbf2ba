// JPEG files of 8-bit RGB pictures.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace stratum::shade {

inline constexpr int kJpegMostSide = 65500;  ///< pixels, of libjpeg

/// Colours are as sharp as brightness (4:4:4): prints have thin lines of other colours.
/// @param rgb       3 * width * height bytes, sRGB, row by row from the top
/// @param quality   1 to 100
/// @param metadata  a comment "KEYWORD: TEXT" each
/// Throws std::invalid_argument for another number of bytes, std::runtime_error if libjpeg can't.
std::vector<std::uint8_t> encodeJpeg(int width, int height, const std::vector<std::uint8_t>& rgb, int quality,
                                     const std::map<std::string, std::string>& metadata = {});

}  // namespace stratum::shade
