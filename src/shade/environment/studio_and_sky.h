// Environments that are computed.
#pragma once

#include "shade/environment/environment.h"

#include <memory>

namespace stratum::shade {

// Studio light: softboxes in a dim room, arranged around the camera so that layer lines are visible.

/// Radiance of an unoccluded white Lambert surface that faces up. Bright enough for a print and the paper under it
/// without exposure compensation.
inline constexpr float kStudioLevel = 1.5f;

/// A key light high on the left, a broad weak fill light on the right, two rim lights behind, and a room that is
/// brighter above than at the horizon. Edges are smooth. Tabulated and sampled as a map; not visible to the camera.
std::shared_ptr<const Environment> makeStudio(const EnvironmentPlacement& placement);

// An analytic clear sky with a sun.

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
