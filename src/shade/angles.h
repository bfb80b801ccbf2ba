// Conversion of angles.
#pragma once

#include <numbers>

namespace stratum::shade {

/// In a degree.
inline constexpr double kRadians = std::numbers::pi / 180.0;
/// In a radian.
inline constexpr double kDegrees = 180.0 / std::numbers::pi;

}  // namespace stratum::shade
