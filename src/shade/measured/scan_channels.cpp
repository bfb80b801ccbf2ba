#include "shade/measured/scan_channels.h"

#include <cmath>

namespace stratum::shade {

ChannelChoice chooseChannels(const std::vector<double>& wavelengths) {
    const auto nearest = [&](double target) {
        std::size_t best = 0;
        for (std::size_t i = 1; i < wavelengths.size(); ++i)
            if (std::abs(wavelengths[i] - target) < std::abs(wavelengths[best] - target)) best = i;
        return best;
    };
    return {nearest(612.0), nearest(549.0), nearest(465.0)};
}

Color fromXyz(double x, double y, double z) {
    // IEC 61966-2-1.
    return Color(glm::dvec3(3.2406 * x - 1.5372 * y - 0.4986 * z, -0.9689 * x + 1.8758 * y + 0.0415 * z,
                            0.0557 * x - 0.2040 * y + 1.0570 * z));
}

}  // namespace stratum::shade
