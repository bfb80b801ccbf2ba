#include "shade/camera/filter.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace stratum::shade {

double PixelFilter::weight(double offset) {
    if (!(std::abs(offset) < kRadius)) return 0.0;
    const double x = std::numbers::pi * (offset + kRadius) / kRadius;  // 0 to 2 pi over the window
    return 0.35875 - 0.48829 * std::cos(x) + 0.14128 * std::cos(2.0 * x) - 0.01168 * std::cos(3.0 * x);
}

PixelFilter::PixelFilter() {
    constexpr int kCells = 1 << 14;
    std::array<double, kCells + 1> cdf{};
    const double width = 2.0 * kRadius / kCells;
    for (std::size_t i = 0; i < kCells; ++i)
        cdf[i + 1] = cdf[i] + weight(-kRadius + (static_cast<double>(i) + 0.5) * width);
    std::size_t cell = 0;
    for (std::size_t n = 0; n < kNodes; ++n) {
        const double target = cdf.back() * static_cast<double>(n) / (kNodes - 1);
        while (cell + 1 < kCells && cdf[cell + 1] < target) ++cell;
        const double part = (target - cdf[cell]) / (cdf[cell + 1] - cdf[cell]);
        quantiles_[n] = -kRadius + (static_cast<double>(cell) + std::clamp(part, 0.0, 1.0)) * width;
    }
}

}  // namespace stratum::shade
