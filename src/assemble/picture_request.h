// All options of a picture, as a command line, a scene file or Python gives them.
#pragma once

#include "assemble/finished_picture.h"
#include "assemble/ready_scene.h"
#include "base/options/option_source.h"
#include "gcode/toolpath/color.h"

#include <optional>
#include <string>
#include <vector>

namespace stratum::assemble {

/// What somebody asked for. The members of PictureOptions are filled in, but find_exposure and TracingOptions::prints
/// and events.
struct PictureRequest : PictureOptions {
    std::optional<bool> denoise;     ///< empty: as fits the picture
    bool spp_given = false;          ///< the samples are asked for, not left to the default
    bool legend = false;             ///< draws what colors mean into the picture
    std::optional<double> exposure;  ///< stops; empty: found from the light
    std::string grid;                ///< of a .vdb; empty: chosen as by --grid
    std::string file_up;             ///< of a .vdb: "y", "z", or empty for what the file says
    /// By tool, of prints; empty: as their files state. See ToolColors.
    std::vector<std::optional<gcode::Rgb>> tool_colors;
    bool photograph = false;         ///< the camera is that of a photograph
    std::vector<std::string> notes;  ///< what a report must say, e.g. the residual of a solved pose

    /// See chooseDenoising().
    /// @param linear  the file keeps linear values
    Denoising denoising(bool linear = false) const { return {denoise, linear, spp_given}; }
};

/// Reads what is given over what `request` has already: a command line over a scene file. Names are those of Python.
/// Refuses options that exclude each other.
/// Throws what the source throws, UsageError for texts that mean nothing, and InputError.
void readPicture(OptionSource& options, PictureRequest& request);

/// Refuses what one integrator alone uses where another makes the picture, and a view beside an eye. Of the last
/// source: a scene may have options of several, for a command line that chooses.
void refuseUnused(OptionSource& options, const PictureRequest& request);

/// Notes a view beside an eye, which a scene may have.
void tellOfUnused(const OptionSource& options, PictureRequest& request);

/// "brick_cache", bytes.
std::optional<std::size_t> brickCacheOf(OptionSource& options);

/// With an error or a time to reach, and no samples asked for: as many as these may need. After the last source.
void completeSamples(PictureRequest& request);

}  // namespace stratum::assemble
