// An analytic clear sky with a sun.
#pragma once

#include "shade/environment/environment.h"

namespace stratum::shade {

struct SkyOptions {
    double elevation = 0.6;  ///< radians: the sun's height above the horizon, above 0 and at most pi/2
    double azimuth = 0.0;    ///< of the sun, radians about +z, from +x
    double turbidity = 3.0;  ///< haze: 2 very clear to 8 hazy
};

/// Sky above dim ground; the sun is a light of its own, half a degree wide (sun()). Scaled so that a white sheet that
/// faces up has the radiance kStudioLevel, sun included.
/// Source: A. Preetham, P. Shirley, B. Smits, "A Practical Analytic Model for Daylight", SIGGRAPH 1999 (sky and the
/// sun's color by Rayleigh scattering and haze); direct to diffuse ratio by the clear-day formula of the IES Lighting
/// Handbook, E = 127.5 klx exp(-0.21 / sin h).
std::shared_ptr<const Environment> makeSky(const SkyOptions& options);

}  // namespace stratum::shade
