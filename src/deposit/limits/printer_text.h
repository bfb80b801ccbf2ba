// The text of a printer's file, and the numbers in it.
#pragma once

#include "gcode/printer/read_options.h"

#include <cstddef>
#include <string>
#include <string_view>

namespace stratum::deposit {

constexpr std::size_t kLargestPrinterFile = std::size_t{1} << 20;  ///< bytes

/// Throws InputError if it can't be read or is larger; `place` is what the message begins with.
std::string readPrinterText(const std::string& path, const std::string& place);

/// The same of a file that another one names: only a regular one, which does not wait for somebody to write into it.
std::string readIncludedText(const std::string& path, const std::string& place);

/// The number that is the whole text, blanks around it aside. Throws InputError "place: what: expected ..." for other
/// text, and for numbers beyond the bounds, both of which belong to them.
double numberIn(std::string_view text, gcode::Bounds bounds, std::string_view place, std::string_view what);

/// Throws InputError if the value is beyond what boundsOf(limit) has.
void checkLimit(gcode::Limit limit, double value, std::string_view place, std::string_view what);

}  // namespace stratum::deposit
