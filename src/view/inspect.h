// What lies under a point of the picture.
#pragma once

#include "view/input/document.h"
#include "view/input/view_scene.h"

#include <glm/vec2.hpp>
#include <nlohmann/json.hpp>

namespace stratum::view {

/// Position, normal and, of G-code, the bead: its layer, feature, tool, object, width, height, speed, time, and its
/// line with those around it. "hit" is false if nothing but bed and background are there.
/// @param picture  whose print is that of `scene`
/// @param pixel    of the picture, from its upper left corner
/// Throws InputError if the file can't be read any more.
nlohmann::json inspect(Document& document, const ViewScene& scene, const ViewedPicture& picture,
                       const glm::dvec2& pixel);

}  // namespace stratum::view
