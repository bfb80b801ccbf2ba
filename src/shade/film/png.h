// PNG files of 8-bit RGB and RGBA with text: writes them, and reads back what it wrote.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
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

/// How a picture is compressed.
enum class PngEffort {
    quick,  ///< half the time of zlib's and libpng's defaults, for files from 3 % smaller to 5 % larger
    small,  ///< for what is looked at more often than made
};

/// Overwrites `path`. Marks the file as sRGB.
/// @param pixels    3 or 4 * width * height bytes, row by row from the top: RGB, or RGBA with colors that are not
///                  multiplied by alpha
/// @param metadata  keyword -> UTF-8 text; written as tEXt, or as iTXt where it isn't ASCII
/// Throws OutputError; std::invalid_argument for a keyword that PNG does not allow.
void writePng(const std::filesystem::path& path, int width, int height, const std::vector<std::uint8_t>& pixels,
              const std::map<std::string, std::string>& metadata);

/// The same bytes in memory.
std::vector<std::uint8_t> encodePng(int width, int height, const std::vector<std::uint8_t>& pixels,
                                    const std::map<std::string, std::string>& metadata,
                                    PngEffort effort = PngEffort::quick);

}  // namespace stratum::shade
