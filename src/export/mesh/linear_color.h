// sRGB as formats of renderers want it.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace stratum::exporter {

/// Linear light of an sRGB color (IEC 61966-2-1), each in [0, 1].
inline std::array<double, 3> linearOf(const std::array<std::uint8_t, 3>& srgb) {
    std::array<double, 3> linear{};
    for (std::size_t n = 0; n < 3; ++n) {
        const double v = srgb[n] / 255.0;
        linear[n] = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    }
    return linear;
}

/// Roughness of plastic in formats that have one: the square of it is the default material's GGX alpha, 0.22.
inline constexpr double kPlasticRoughness = 0.47;

}  // namespace stratum::exporter
