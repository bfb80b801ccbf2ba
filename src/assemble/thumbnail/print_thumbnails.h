// Pictures of a print for gcode::ThumbnailFile.
#pragma once

#include "assemble/file/read_events.h"
#include "gcode/thumbnail/thumbnail.h"
#include "gcode/toolpath/toolpath.h"
#include "voxelize/grid/print_options.h"

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace stratum::assemble {

struct ThumbnailOptions {
    /// Which beads are shown; all but skirts and prime towers, if no features are chosen. Where no voxel size is given,
    /// it follows from the largest picture's pixels.
    voxelize::PrintOptions print;
    ReadEvents events;
};

/// One picture for each size, in their order: the part in studio light from the front left above, in the colors that
/// the file states, without a bed; PNG and QOI are transparent around it, JPG and BMP black. The print is read once for
/// all of them. Runs on the threads that TBB may use; the same bytes for any number of them.
/// @param name  of the file, for messages
/// Throws InputError for a print without beads, UsageError for options that don't fit it.
std::vector<gcode::Thumbnail> makeThumbnails(const std::shared_ptr<const gcode::Toolpath>& toolpath,
                                             const std::string& name, std::span<const gcode::ThumbnailSize> sizes,
                                             const ThumbnailOptions& options = {});

}  // namespace stratum::assemble
