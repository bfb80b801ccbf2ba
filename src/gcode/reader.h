// Bytes -> Toolpath: the entry point of this library.
#pragma once

#include "gcode/printer/read_options.h"
#include "gcode/toolpath/toolpath.h"

#include <string_view>

namespace stratum::gcode {

/// Reads one G-code program, also inside a container (container.h). `name` is used in messages. Throws
/// InputError (with "name:line: ...") for bytes that are not G-code, unusable numbers, or a program that deposits
/// nothing; UsageError for options out of range. Single-threaded, re-entrant.
Toolpath readToolpath(std::string_view bytes, std::string_view name, const ReadOptions& options = {});

}  // namespace stratum::gcode
