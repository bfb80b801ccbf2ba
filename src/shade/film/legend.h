// The legend of a picture's colors: as data for a report, and drawn into the picture.
#pragma once

#include "shade/color.h"

#include <cstdint>
#include <string>
#include <vector>

namespace stratum::shade {

/// Names with colors, or a ramp between two numbers; one of the two is empty.
struct Legend {
    struct Entry {
        std::string name;
        Color color{0.0f};  ///< linear reflectance
    };
    std::string title;           ///< the attribute, e.g. "feature"
    std::string unit;            ///< of a ramp's numbers, e.g. "mm/s"; may be empty
    std::vector<Entry> entries;  ///< of existing values, ascending
    std::vector<Color> ramp;     ///< linear, from `least` to `most`, evenly
    double least = 0.0, most = 0.0;
};

/// Draws it into the upper left corner of an 8-bit sRGB picture, on a light panel, in a size relative to the picture's
/// height. Entries that don't fit are left out, and the last line states their number.
/// @param rgb  3 * width * height bytes, row by row from the top
void draw(const Legend& legend, int width, int height, std::vector<std::uint8_t>& rgb);

}  // namespace stratum::shade
