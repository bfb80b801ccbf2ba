#include "export/parts/checksum.h"

#include <fmt/format.h>
#include <zlib.h>

namespace stratum::exporter {

std::uint32_t checksumOf(std::string_view bytes, std::uint32_t before) {
    return static_cast<std::uint32_t>(
        ::crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

std::string identityOfPart(std::string_view before_leaves) {
    return fmt::format("part of a print, {:08x} {}", checksumOf(before_leaves), before_leaves.size());
}

}  // namespace stratum::exporter
