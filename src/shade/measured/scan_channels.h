// From the spectral channels of a file to the three of a Color.
#pragma once

#include <vector>

namespace stratum::shade {

/// Indices of the wavelengths (nm) for red, green and blue: the nearest to 612, 549 and 465 nm, the dominant
/// wavelengths of the primaries. A single wavelength is used for all three: gray.
struct ChannelChoice {
    std::size_t red, green, blue;
};
ChannelChoice chooseChannels(const std::vector<double>& wavelengths);

}  // namespace stratum::shade
