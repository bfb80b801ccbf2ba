// The size of a PNG, from its first chunk. Source: PNG Specification (Third Edition), 11.2.1 IHDR.
#pragma once

#include "gcode/thumbnail/thumbnail.h"

#include <optional>
#include <string_view>

namespace stratum::gcode {

/// Nothing if the bytes begin no PNG, or one larger than kMostThumbnailSide.
std::optional<ThumbnailSize> pngSize(std::string_view bytes);

}  // namespace stratum::gcode
