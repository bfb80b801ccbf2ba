// A picture for a view that moves: free of noise after one ray and one occlusion ray a pixel.
#pragma once

#include "shade/integrator/bare_light.h"
#include "view/input/view_scene.h"

#include <cstdint>
#include <vector>

namespace stratum::view {

/// Radiance is estimated as albedo times the light that reaches a surface of that normal if nothing is in its way
/// (shade::BareLight), times the ambient occlusion, whose samples are smoothed over neighbours of like normal and
/// depth. Shadows are soft and not those of the finished picture; colours and brightness are about its own.
/// @param light  of the picture's scene; made again only when that changes, since it takes as long as a small picture
/// Runs on the threads that TBB may use. Returns 3 * width * height bytes, sRGB; the size is the camera's.
std::vector<std::uint8_t> quickPicture(const ViewedPicture& picture, const shade::BareLight& light);

}  // namespace stratum::view
