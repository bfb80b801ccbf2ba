// CRC-32, with which files of parts say whether they are as they were written, and SHA-256, which identifies inputs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace stratum {

/// Of what was before (0: nothing) and of these bytes.
std::uint32_t checksumOf(std::string_view bytes, std::uint32_t before = 0);

/// checksumOf() of `count` values in memory.
template <typename T>
std::uint32_t checksumOf(const T* values, std::size_t count, std::uint32_t before = 0) {
    return checksumOf(std::string_view(reinterpret_cast<const char*>(values), count * sizeof(T)), before);
}

/// SHA-256 of the bytes as 64 lower-case hex digits, the same as `sha256sum` prints.
std::string sha256Hex(std::string_view bytes);

}  // namespace stratum
