// Writes 8-bit RGB and RGBA pictures with text metadata as PNG.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace stratum::shade {

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
