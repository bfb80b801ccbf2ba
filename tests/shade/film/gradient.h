// A smooth picture, and how far another one is from it.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

namespace stratum::test {

inline std::vector<std::uint8_t> gradient(int width, int height) {
    std::vector<std::uint8_t> rgb;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            rgb.push_back(static_cast<std::uint8_t>(std::lround(255.0 * x / width)));
            rgb.push_back(static_cast<std::uint8_t>(std::lround(255.0 * y / height)));
            rgb.push_back(static_cast<std::uint8_t>(std::lround(127.0 * (x + y) / (width + height))));
        }
    return rgb;
}

/// Of values of 0 to 255.
inline double meanDifference(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
    if (a.size() != b.size()) return 255;
    double sum = 0;
    for (std::size_t n = 0; n < a.size(); ++n) sum += std::abs(a[n] - b[n]);
    return sum / static_cast<double>(a.size());
}

}  // namespace stratum::test
