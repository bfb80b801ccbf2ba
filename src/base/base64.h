// Base64 (RFC 4648).
#pragma once

#include <string>
#include <string_view>

namespace stratum {

/// Padded, in one line.
std::string base64Of(std::string_view bytes);

/// The bytes of a text whose padding may be missing; empty if it is no base64.
std::string bytesOfBase64(std::string_view text);

}  // namespace stratum
