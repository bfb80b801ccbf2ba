// Heatshrink, the LZSS dialect for microcontrollers that binary G-code uses.
// Source: github.com/atomicobject/heatshrink (README and the comments of heatshrink_decoder.c describe the bit stream).
#pragma once

#include <span>
#include <string_view>

namespace stratum::gcode {

/// Fills all of `out` from `packed`. Window and lookahead in bits: 4 to 15, and 3 to one less than the window. Returns
/// "" or the fault in the bytes, as the end of a sentence. Never reads or writes out of bounds; thread-safe.
[[nodiscard]] std::string_view decodeHeatshrink(std::string_view packed, int window_bits, int lookahead_bits,
                                                std::span<char> out);

}  // namespace stratum::gcode
