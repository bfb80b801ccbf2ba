// Thumbnails in binary G-code: blocks of type 5. Source: github.com/prusa3d/libbgcode, doc/specifications.md.
#pragma once

#include "gcode/thumbnail/patched_bytes.h"
#include "gcode/thumbnail/thumbnail.h"

#include <span>
#include <string_view>

namespace stratum::gcode {

/// The file with these thumbnails and no others: where its own stood, else behind the printer's metadata. All other
/// blocks keep their bytes. Throws InputError for damage, which it names by block.
PatchedBytes withBgcodeThumbnails(std::string_view bytes, std::span<const Thumbnail> thumbnails, std::string_view name);

}  // namespace stratum::gcode
