// The pictures of FlashPrint's .gx: a BMP of 80 x 60 pixels with 24 bits each, and in newer files a PNG of any size
// behind it. See gcode/container/gx.h for the layout and its sources.
#pragma once

#include "gcode/thumbnail/patched_bytes.h"
#include "gcode/thumbnail/thumbnail.h"

#include <span>
#include <string_view>
#include <vector>

namespace stratum::gcode {

/// The pictures that the file has to hold: its BMP, and its PNG if it has one, in the size that is asked for or else in
/// its own. Throws UsageError if others are asked for, InputError if the file has no picture.
std::vector<ThumbnailSize> gxPictures(std::string_view bytes, std::span<const ThumbnailSize> asked,
                                      std::string_view name);

/// The file with those pictures; the offsets in its head follow them.
PatchedBytes withGxThumbnails(std::string_view bytes, std::span<const Thumbnail> pictures);

}  // namespace stratum::gcode
