// What packs the text in binary G-code, besides deflate.
#pragma once

#include "gcode/container/byte_buffer.h"

#include <span>
#include <string_view>

namespace stratum::gcode {

// MeatPack packs two of the fifteen most frequent characters of G-code into one byte.
// Sources: github.com/scottmudge/OctoPrint-MeatPack (the packing), prusa3d/libbgcode doc/specifications.md (where
// binary G-code uses it; its second form switches packing off for comment lines, which the same decoder understands).

/// Appends the unpacked text to `text`: at most twice as many bytes. Every call starts with packing off, as every block
/// of binary G-code does. Returns "" or the fault in the bytes, as the end of a sentence.
[[nodiscard]] std::string_view unpackMeatPack(std::string_view packed, ByteBuffer& text);

// Heatshrink, the LZSS dialect for microcontrollers that binary G-code uses.
// Source: github.com/atomicobject/heatshrink (README and the comments of heatshrink_decoder.c describe the bit stream).

/// Fills all of `out` from `packed`. Window and lookahead in bits: 4 to 15, and 3 to one less than the window. Returns
/// "" or the fault in the bytes, as the end of a sentence. Never reads or writes out of bounds; thread-safe.
[[nodiscard]] std::string_view decodeHeatshrink(std::string_view packed, int window_bits, int lookahead_bits,
                                                std::span<char> out);

}  // namespace stratum::gcode
