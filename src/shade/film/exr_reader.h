// Reads OpenEXR pictures.
#pragma once

#include "shade/color.h"

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::shade {

/// The R, G and B channels (or Y alone, as gray) of the data window, row by row from the top, and the attributes of the
/// header.
struct ExrImage {
    int width = 0;
    int height = 0;
    std::vector<Color> rgb;
    std::map<std::string, std::string> attributes;  ///< string, int and float attributes as text, by name
};

bool isExr(std::string_view bytes);

/// Reads the first part of a file, scanlines or tiles.
/// @param most  pixels; a larger picture is refused before memory is allocated
/// Throws InputError.
ExrImage readExr(const std::filesystem::path& path, std::size_t most);

}  // namespace stratum::shade
