// Radiance RGBE pictures.
#pragma once

#include "shade/environment/light_map.h"

#include <string_view>

namespace stratum::shade {

/// Whether these are the first bytes of a Radiance picture.
bool isHdr(std::string_view bytes);

/// Decodes a picture. Unknown header lines are skipped; EXPOSURE and COLORCORR lines are undone, as the format asks,
/// and PRIMARIES are heeded. Without these a file counts as Rec. 709, as those who publish maps mean it. Source: G.
/// Ward, "Real Pixels", Graphics Gems II, and Radiance's own "picture" man page.
/// @param name  for messages
/// Throws InputError.
LightMap readHdr(std::string_view bytes, std::string_view name);

}  // namespace stratum::shade
