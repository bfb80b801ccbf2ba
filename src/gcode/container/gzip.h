// gzip-compressed text, RFC 1952.
#pragma once

#include "gcode/container/container.h"

namespace stratum::gcode {

bool isGzip(std::string_view bytes);

/// Unpacks all members, one after the other, and checks the CRC32 and size of each. Throws InputError.
Program openGzip(std::string_view bytes, std::string_view name, const ContainerLimits& limits,
                 const Progress& progress = {});

}  // namespace stratum::gcode
