// The reconstruction filter of pixels.
#pragma once

#include <glm/vec2.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

namespace stratum::shade {

/// A separable Blackman-Harris window, by importance sampling instead of weights: every sample belongs to one pixel and
/// has the same weight, so that each pixel is owned by one thread.
/// Source: M. Ernst, M. Stamminger, G. Greiner, "Filter Importance Sampling", IEEE RT 2006.
class PixelFilter {
public:
    static constexpr double kRadius = 1.5;  ///< pixels

    PixelFilter();
    /// Offset from the pixel's center, in pixels, within +-kRadius.
    /// @param u  uniform in [0, 1)^2
    glm::dvec2 offset(const glm::vec2& u) const { return {quantile(u.x), quantile(u.y)}; }
    /// The offsets at equal steps of u, from 0 to 1; between them offset() is linear.
    static constexpr int kNodes = 1025;
    const std::array<double, kNodes>& quantiles() const { return quantiles_; }
    /// The window's weight, for checking; 0 beyond the radius.
    static double weight(double offset);

private:
    double quantile(float u) const {
        const double s = static_cast<double>(u) * (kNodes - 1);
        const int i = std::min(static_cast<int>(s), kNodes - 2);
        const double w = s - i;
        const auto n = static_cast<std::size_t>(i);
        return (1.0 - w) * quantiles_[n] + w * quantiles_[n + 1];
    }

    std::array<double, kNodes> quantiles_{};
};

}  // namespace stratum::shade
