// How a .vdb file begins.
#pragma once

#include <string_view>

namespace stratum::march {

/// OPENVDB_MAGIC of OpenVDB's version.h, as the eight bytes that io::Archive writes.
inline constexpr std::string_view kVdbMagic(" BDV\0\0\0\0", 8);

}  // namespace stratum::march
