// Options of Python -> a picture.
#pragma once

#include "python/options/keywords.h"

#include "assemble/ready_scene.h"

#include <optional>
#include <string>
#include <vector>

namespace stratum::python {

/// All that render() takes besides its source.
struct RenderCall {
    assemble::PictureOptions picture;
    std::optional<bool> denoise;  ///< empty: as fits the picture
    bool spp_given = false;
    bool legend = false;
    std::optional<double> exposure;  ///< stops; empty: found from the light
    std::string grid, file_up;       ///< of a .vdb
    /// Of a print that is read here, by tool; empty: as its file states.
    std::vector<std::optional<gcode::Rgb>> tool_colors;
    std::vector<std::string> of_prints,
        of_reading;  ///< names of options that are given: of G-code alone; of its reading
};

/// As vdbtrace's options of those names. Throws UsageError.
RenderCall renderCallOf(Keywords& options);

}  // namespace stratum::python
