// A latitude-longitude map of radiance, as in .hdr and .exr files.
#pragma once

#include "shade/color.h"

#include <cstddef>
#include <filesystem>
#include <vector>

namespace stratum::shade {

/// Radiance by direction, row by row from straight up to straight down. Texel (x, y) is the radiance at its center:
/// azimuth (x + 0.5) / width of a turn, polar angle (y + 0.5) / height of pi.
struct LightMap {
    int width = 0;   ///< texels
    int height = 0;  ///< texels
    std::vector<Color> texels;

    const Color& at(int x, int y) const {
        return texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    }
};

/// The largest map that is read: 2^27 texels, 1.6 GB. 16384 x 8192 is the largest that people publish.
inline constexpr std::size_t kMostMapTexels = std::size_t{1} << 27;

/// The brightest texel of a map, scaled: sums of radiances, their squares and products with BRDFs stay far from the
/// largest float. The sun is a thousand times darker in W/(m^2 sr) nm and in cd/m^2.
inline constexpr float kBrightestTexel = 1e12f;

/// Reads a .hdr or .exr map, recognized by content. Throws InputError: missing, of another kind, damaged, too large,
/// not twice as wide as high, with texels that are no number or, scaled, above kBrightestTexel, black all over, or with
/// more than 2 % of its radiance below 0; less of it is taken as 0. Colors of other primaries that the file states
/// (chromaticities, PRIMARIES=) become those of Rec. 709.
/// @param stops  all texels are scaled by 2^stops
LightMap readLightMap(const std::filesystem::path& path, double stops = 0.0);

}  // namespace stratum::shade
