// How damage to a part is found.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace stratum::exporter {

/// CRC-32 of what was before and of these bytes.
std::uint32_t checksumOf(std::string_view bytes, std::uint32_t before = 0);

/// For VdbArchive::header(): makes the UUID of a part tell whether what stands between the header and the leaves is as
/// it was written.
std::string identityOfPart(std::string_view before_leaves);

}  // namespace stratum::exporter
