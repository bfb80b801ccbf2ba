// OpenEXR: films as files, linear and in full precision; pictures read back; and headers checked before OpenEXR trusts
// their sizes.
#pragma once

#include "shade/color.h"
#include "shade/film/film.h"
#include "shade/primaries.h"

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::shade {

/// OpenEXR allocates memory for tables, lines and attributes as stated in the header, before it reads the data: a file
/// of a hundred bytes can request gigabytes. This checks the headers of all parts first.
/// Throws InputError, beginning with `name`: an attribute that is longer than the file, a picture of more than `most`
/// pixels or wider or higher than 2^17, more chunks than fit into the file, more data than the bytes can unpack to
/// (2048 times their number, 65536 times with DWA compression; a picture of one color takes a tenth of that), deep
/// data.
void checkExrHeader(std::string_view bytes, std::size_t most, std::string_view name);

/// The R, G and B channels (or Y alone, as gray) of the data window, row by row from the top, and the attributes of the
/// header.
struct ExrImage {
    int width = 0;
    int height = 0;
    std::vector<Color> rgb;
    std::map<std::string, std::string> attributes;  ///< string, int and float attributes as text, by name
    Primaries primaries;                            ///< Rec. 709's where the header states none
};

bool isExr(std::string_view bytes);

/// Reads the first part of a file, scanlines or tiles.
/// @param most  pixels; a larger picture is refused before memory is allocated
/// Throws InputError.
ExrImage readExr(const std::filesystem::path& path, std::size_t most);

/// Overwrites `path` with channels R, G, B, A: 32-bit float, linear, premultiplied, ZIP-compressed, Rec. 709 primaries.
/// The film's layers follow as channels LAYER.CHANNEL. The display window is the frame, the data window the film's
/// region.
/// @param metadata  name -> UTF-8 text, written as string attributes
/// Throws OutputError; std::invalid_argument for a name that is reserved by the format.
void writeExr(const std::filesystem::path& path, const Film& film, const std::map<std::string, std::string>& metadata);

}  // namespace stratum::shade
