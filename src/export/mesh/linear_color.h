// sRGB as formats of renderers want it.
#pragma once

#include "base/srgb.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace stratum::exporter {

/// Linear light of an sRGB color, each in [0, 1].
inline std::array<double, 3> linearOf(const std::array<std::uint8_t, 3>& srgb) {
    std::array<double, 3> linear{};
    for (std::size_t n = 0; n < 3; ++n) linear[n] = linearOfSrgb(srgb[n] / 255.0);
    return linear;
}

/// Roughness of plastic in formats that have one: the square of it is the default material's GGX alpha, 0.22.
inline constexpr double kPlasticRoughness = 0.47;

}  // namespace stratum::exporter
