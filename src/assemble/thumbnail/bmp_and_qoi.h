// Pictures as files for thumbnails that no library here writes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace stratum::assemble {

// BMP files of 8-bit RGB pictures, as FlashPrint's .gx has them: BITMAPINFOHEADER, 24 bits a pixel, rows from below.
// Source: Microsoft, "Bitmap Storage".

/// @param rgb  3 * width * height bytes, row by row from the top
/// Throws std::invalid_argument for another number of bytes.
std::string encodeBmp(int width, int height, const std::vector<std::uint8_t>& rgb);

// QOI files of 8-bit RGBA pictures. Source: The Quite OK Image Format, Specification Version 1.0, qoiformat.org.

/// Lossless.
/// @param rgba  4 * width * height bytes, sRGB, row by row from the top
/// Throws std::invalid_argument for another number of bytes.
std::string encodeQoi(int width, int height, const std::vector<std::uint8_t>& rgba);

}  // namespace stratum::assemble
