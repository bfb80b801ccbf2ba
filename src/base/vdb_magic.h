// How a .vdb file begins; here for rooms without OpenVDB too.
#pragma once

#include <string_view>

namespace stratum {

/// OPENVDB_MAGIC of OpenVDB's version.h, as the eight bytes that io::Archive writes.
inline constexpr std::string_view kVdbMagic(" BDV\0\0\0\0", 8);

}  // namespace stratum
