#include "shade/measured/scan_text.h"

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

}  // namespace stratum::shade
