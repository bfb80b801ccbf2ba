// QOI files of 8-bit RGBA pictures. Source: The Quite OK Image Format, Specification Version 1.0, qoiformat.org.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace stratum::assemble {

/// Lossless.
/// @param rgba  4 * width * height bytes, sRGB with linear alpha, row by row from the top
/// Throws std::invalid_argument for another number of bytes.
std::string encodeQoi(int width, int height, const std::vector<std::uint8_t>& rgba);

}  // namespace stratum::assemble
