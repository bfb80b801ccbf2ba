// MeatPack packs two of the fifteen most frequent characters of G-code into one byte.
// Sources: github.com/scottmudge/OctoPrint-MeatPack (the packing), prusa3d/libbgcode doc/specifications.md (where
// binary G-code uses it; its second form switches packing off for comment lines, which the same decoder understands).
#pragma once

#include "gcode/container/byte_buffer.h"

#include <string_view>

namespace stratum::gcode {

/// Appends the unpacked text to `text`: at most twice as many bytes. Every call starts with packing off, as every block
/// of binary G-code does. Returns "" or the fault in the bytes, as the end of a sentence.
[[nodiscard]] std::string_view unpackMeatPack(std::string_view packed, ByteBuffer& text);

}  // namespace stratum::gcode
