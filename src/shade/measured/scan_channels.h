// From the spectral channels of a file to the three of a Color.
#pragma once

#include "shade/color.h"

#include <string_view>
#include <vector>

namespace stratum::shade {

/// Indices of the wavelengths (nm) for red, green and blue: the nearest to 612, 549 and 465 nm, the dominant
/// wavelengths of the primaries. A single wavelength is used for all three: gray.
struct ChannelChoice {
    std::size_t red, green, blue;
};
ChannelChoice chooseChannels(const std::vector<double>& wavelengths);

/// CIE XYZ (white (0.9505, 1, 1.089)) to linear Rec. 709.
Color fromXyz(double x, double y, double z);

}  // namespace stratum::shade
