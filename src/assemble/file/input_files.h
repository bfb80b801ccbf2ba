// The files that a picture is made of.
#pragma once

#include "assemble/file/object_file.h"
#include "shade/scene/scene.h"

#include <string>
#include <vector>

namespace stratum::assemble {

/// Objects, their materials, those of the scene, its light, and the two files whose paths are given, if there are any.
/// Presets and shapes by formula are none. In this order; one may be there twice.
/// @param printer      PrintOptions::printer; the name of a preset is taken for a path
/// @param camera_path  of a film
std::vector<std::string> inputFiles(const std::vector<ObjectOptions>& objects, const shade::SceneOptions& scene,
                                    const std::string& printer, const std::string& camera_path = {});

}  // namespace stratum::assemble
