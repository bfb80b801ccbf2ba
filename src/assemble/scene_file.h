// A picture described in a file: JSON.
#pragma once

#include "assemble/file/object_file.h"
#include "assemble/picture_request.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::assemble {

/// All that makes a picture. docs/shading.md has the schema with an example.
struct SceneFile : PictureRequest {
    std::string print;                   ///< the level set; empty if there are `objects`
    std::string output;                  ///< empty: named after the scene file; relative to the working directory
    std::vector<ObjectOptions> objects;  ///< empty: `print` alone
};

/// Whether a text looks like a scene: its first character is a brace.
bool isSceneFile(std::string_view text);

/// Reads a scene. File names in it are relative to its own folder. Throws InputError: place of a syntax error, the path
/// of a value of the wrong kind, an unknown key and the known one that is most like it.
SceneFile readSceneFile(const std::filesystem::path& path);

}  // namespace stratum::assemble
