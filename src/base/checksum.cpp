#include "base/checksum.h"

#include <libdeflate.h>
#include <zlib.h>

namespace stratum {

// By carry-less multiplication: five times as fast as zlib's, where gigabytes are read for nothing else.
std::uint32_t checksumOf(std::string_view bytes, std::uint32_t before) {
    return ::libdeflate_crc32(before, bytes.data(), bytes.size());
}

std::uint32_t checksumOfBoth(std::uint32_t first, std::uint32_t second, std::uint64_t second_bytes) {
    return static_cast<std::uint32_t>(::crc32_combine64(first, second, static_cast<z_off64_t>(second_bytes)));
}

}  // namespace stratum
