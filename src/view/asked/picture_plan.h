// From what the viewer was started with and what a page chose to the options of a picture, and to the command line of
// vdbtrace that makes the same picture.
#pragma once

#include "assemble/file/object_file.h"
#include "assemble/finished_picture.h"
#include "assemble/picture_request.h"
#include "assemble/ready_scene.h"
#include "view/asked/view_state.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace stratum::view {

/// One input as it was given on the command line, with the options there, or with those of its scene file.
struct GivenInput {
    std::string path;                              ///< as given
    std::vector<assemble::ObjectOptions> objects;  ///< none: its scene file could not be read
    assemble::PictureRequest options;              ///< without events
    std::string source;                            ///< the file that vdbtrace states in its pictures
    std::vector<std::string> words;                ///< options on the command line, as vdbtrace takes them
    /// Reads its scene file anew. Throws InputError. Empty: it stays as it is.
    std::function<GivenInput()> again;
};

/// A picture that a page asks for.
struct PicturePlan {
    assemble::PictureOptions options;  ///< with samples and denoiser's layers, as vdbtrace chooses them
    bool denoise = false;
    bool legend = false;
    bool own_materials = true;       ///< objects have those of their scene
    std::optional<double> exposure;  ///< empty: found from the light
    std::vector<std::string> words;  ///< the command line of vdbtrace, without -o
    std::string objects_key;         ///< equal if the objects in front of the camera are
    std::string light_key;           ///< equal if bed and lights are, but for what turns with the camera
};

/// Throws UsageError for states that don't fit the input.
PicturePlan planPicture(const GivenInput& given, const ViewState& state);

/// Words as a line for a shell.
std::string shellLine(const std::vector<std::string>& words);

}  // namespace stratum::view
