// Thumbnails in the text of G-code: comments with base64.
//
//   ; thumbnail begin 300x300 12345       PNG; thumbnail_JPG and thumbnail_QOI for the others. 12345 is the length of
//   ; iVBORw0KGgo...                      the base64, in lines of at most 78 characters
//   ; thumbnail end
//
// Sources: PrusaSlicer, src/libslic3r/GCode/Thumbnails.hpp (form, and the lines ";" around a block); OrcaSlicer, the
// same file and GCode.cpp (blocks stand between THUMBNAIL_BLOCK_START and _END); Cura, CreateThumbnail.py (PNG alone,
// "begin 300 300 12345", behind the line ";Generated with Cura"). What reads them, e.g. Moonraker's metadata.py, takes
// blocks from anywhere.
#pragma once

#include "gcode/thumbnail/patched_bytes.h"
#include "gcode/thumbnail/thumbnail.h"

#include <span>
#include <string_view>

namespace stratum::gcode {

/// Whether the text has thumbnails, or the place that Orca leaves for them. Throws InputError for a block without an
/// end.
bool hasThumbnailPlace(std::string_view text, std::string_view name);

/// The text with these thumbnails and no others, where its own stood; else where the text's slicer writes them, or
/// behind the first line if it is unknown. Line ends are the text's. The same thumbnails again change nothing. `name`
/// is used in messages. Throws InputError for a block without an end.
PatchedBytes withTextThumbnails(std::string_view text, std::span<const Thumbnail> thumbnails, std::string_view name);

}  // namespace stratum::gcode
