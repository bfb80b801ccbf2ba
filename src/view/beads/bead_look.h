// How the beads of a page look: light, bed and colours, as near to those of the finished picture as a table says them.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "shade/integrator/bare_light.h"
#include "view/input/view_scene.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace stratum::view {

/// The camera of a picture as pages take it.
nlohmann::json cameraJson(const shade::Camera& camera);

/// Bed, backdrop, exposure and the material's colour. With `light`: its table over the octahedral square, row by row,
/// matt and gloss, see shade::BareLight; "follows" if it stands beside the camera and turns with it about +z from
/// "right".
nlohmann::json lookOf(const ViewedPicture& picture, const PicturePlan& plan, const shade::BareLight* light);

/// Colours of the beads by the attribute that the picture is coloured by.
struct BeadColors {
    std::vector<std::uint16_t> places;  ///< by bead
    std::vector<shade::Color> palette;  ///< linear reflectance
    std::vector<float> values;          ///< of the attribute, by colour: of the first bead that has it
};
/// Of the first object of the picture. Empty if it has one colour.
/// @param attribute  by which the picture is coloured
BeadColors colorsOf(const ViewedPicture& picture, const gcode::Toolpath& toolpath, const std::string& attribute);

}  // namespace stratum::view
