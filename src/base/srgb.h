// The transfer function of sRGB (IEC 61966-2-1).
#pragma once

#include <cmath>

namespace stratum {

/// Linear light of an encoded value, both in [0, 1].
inline double linearOfSrgb(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

/// The encoded value of linear light, both in [0, 1].
template <typename Real>
Real srgbOfLinear(Real linear) {
    return linear <= Real(0.0031308) ? Real(12.92) * linear
                                     : Real(1.055) * std::pow(linear, Real(1) / Real(2.4)) - Real(0.055);
}

}  // namespace stratum
