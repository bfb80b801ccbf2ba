// JPEG for pictures that are seen for a moment.
#pragma once

#include <cstdint>
#include <vector>

namespace stratum::view {

/// @param rgb      3 * width * height bytes, sRGB, row by row from the top
/// @param quality  1 to 100
/// Throws std::runtime_error if libjpeg can't.
std::vector<std::uint8_t> encodeJpeg(int width, int height, const std::vector<std::uint8_t>& rgb, int quality);

}  // namespace stratum::view
