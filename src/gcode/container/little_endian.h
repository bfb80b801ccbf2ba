// Little-endian integers in unaligned bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace stratum::gcode {

/// The `count` (1 to 4) bytes at `offset` as a number. They must be within the bytes.
inline std::uint32_t littleEndian(std::string_view bytes, std::size_t offset, std::size_t count) {
    std::uint32_t value = 0;
    for (std::size_t i = count; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[offset + i]);
    return value;
}

/// Appends the lowest `count` (1 to 4) bytes of a number.
inline void appendLittleEndian(std::string& bytes, std::uint32_t value, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xff);
}

}  // namespace stratum::gcode
