// FlashPrint's .gx: "xgcode 1.0\n", a little-endian header, thumbnails, then plain text to the end of the file.
// No vendor document; the layout as others have read it from files: the README of github.com/ronoaldo/
// FlashforgeFinderIntegration (text from byte 14512 on behind one BMP) and encoders by others that agree with it:
// 0x10 offset of a BMP, 0x14 of a PNG (or of the text where there is none), 0x18 of the text, 0x20 and 0x24 filament of
// the right and left nozzle in mm. Nothing in it is checksummed.
#pragma once

#include "gcode/container/container.h"

#include <cstddef>

namespace stratum::gcode {

/// Offsets in its head, of numbers of four bytes.
namespace gx {
inline constexpr std::size_t kBitmapAt = 0x10, kPngAt = 0x14, kTextAt = 0x18, kSecondsAt = 0x1c;
inline constexpr std::size_t kRightFilamentAt = 0x20, kLeftFilamentAt = 0x24;
inline constexpr std::size_t kHeaderBytes = 58;
}  // namespace gx

bool isGx(std::string_view bytes);

/// Finds the text, as a view of `bytes`. Throws InputError if the header is truncated or its offset of the text is
/// impossible.
Program openGx(std::string_view bytes, std::string_view name);

}  // namespace stratum::gcode
