// How far a picture is from a reference.
#pragma once

#include "shade/film/film.h"

#include <cstddef>
#include <vector>

namespace stratum::study {

/// mean((x - r)^2 / (r^2 + 0.01)) over pixels and channels: relative where there is light, absolute where there is
/// none. Linear values; films of one size (std::invalid_argument if not).
double relativeSquaredError(const shade::Film& picture, const shade::Film& reference);

/// Two kinds of pictures of one scene, each rendered twice with seeds of its own: how much of their difference is
/// noise.
struct Separated {
    double noise = 0;  ///< relMSE of one picture of the first kind against its own limit
    double bias = 0;   ///< relMSE between the limits of both kinds; unbiased, so it may come out a little below zero
};
/// The bias is the mean product of two independent differences: (a1 - b1)(a2 - b2) / (r^2 + 0.01), r the mean of all.
Separated separateNoise(const shade::Film& a1, const shade::Film& a2, const shade::Film& b1, const shade::Film& b2);

/// A picture as a screen shows it: sRGB-encoded values in [0, 1], row by row from the top. Not rounded to bytes.
struct DisplayPicture {
    int width = 0, height = 0;
    std::vector<shade::Color> pixels;

    const shade::Color& at(int x, int y) const {
        return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    }
};

/// As shade::toDisplay() makes it of light and of shares, without its dither.
DisplayPicture displayed(const shade::Film& film);

}  // namespace stratum::study
