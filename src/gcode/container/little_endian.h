// Little-endian integers from unaligned bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace stratum::gcode {

/// The `count` (1 to 4) bytes at `offset` as a number. They must be within the bytes.
inline std::uint32_t littleEndian(std::string_view bytes, std::size_t offset, std::size_t count) {
    std::uint32_t value = 0;
    for (std::size_t i = count; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[offset + i]);
    return value;
}

}  // namespace stratum::gcode
