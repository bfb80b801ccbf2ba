// BMP files of 8-bit RGB pictures, as FlashPrint's .gx has them: BITMAPINFOHEADER, 24 bits a pixel, rows from below.
// Source: Microsoft, "Bitmap Storage".
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace stratum::assemble {

/// @param rgb  3 * width * height bytes, row by row from the top
/// Throws std::invalid_argument for another number of bytes.
std::string encodeBmp(int width, int height, const std::vector<std::uint8_t>& rgb);

}  // namespace stratum::assemble
