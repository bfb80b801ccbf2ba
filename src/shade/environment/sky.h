// A clear sky with its sun, without any file.
#pragma once

#include "shade/environment/environment.h"

namespace stratum::shade {

struct SkyOptions {
    double elevation = 0.6;  ///< radians: the sun's height above the horizon, above 0 and at most pi/2
    double azimuth = 0.0;    ///< radians about +z, from +x: where the sun stands
    double turbidity = 3.0;  ///< haze: 2 very clear to 8 hazy
};

/// The blue of the sky and dim ground; the sun is a light of its own, half a degree wide (sun()). Scaled so that a
/// white sheet that looks up has the radiance kStudioLevel, sun included.
/// Source: A. Preetham, P. Shirley, B. Smits, "A Practical Analytic Model for Daylight", SIGGRAPH 1999 (sky and the
/// sun's colour by Rayleigh scattering and haze); direct to diffuse ratio by the clear-day formula of the IES Lighting
/// Handbook, E = 127.5 klx exp(-0.21 / sin h).
std::shared_ptr<const Environment> makeSky(const SkyOptions& options);

}  // namespace stratum::shade
