// Binary G-code, version 1. Source: github.com/prusa3d/libbgcode, doc/specifications.md.
#pragma once

#include "gcode/container/container.h"

namespace stratum::gcode {

bool isBgcode(std::string_view bytes);

/// Unpacks the G-code blocks in order and appends the metadata as comments, "; key = value", as in ASCII files of the
/// same slicer. Checks the CRC32 of every block if the file has them; thumbnails are not decoded.
/// Throws InputError that names the block and its offset.
Program openBgcode(std::string_view bytes, std::string_view name, const ContainerLimits& limits,
                   const Progress& progress = {});

}  // namespace stratum::gcode
