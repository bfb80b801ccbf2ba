// Reads PNG files back: those that png_writer.h wrote.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

namespace stratum::shade {

struct PngPixels {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;  ///< 3 bytes a pixel, row by row from the top
};

/// The pixels of a PNG with 8 bits a channel as they are in the file, without gamma; nothing if it is damaged, cut
/// short or no PNG.
std::optional<PngPixels> decodePng(std::string_view bytes);

}  // namespace stratum::shade
