// Text of other programs as UTF-8.
#pragma once

#include <string>
#include <string_view>

namespace stratum {

/// Whether the bytes are UTF-8: shortest forms, no surrogates, at most U+10FFFF.
bool isUtf8(std::string_view text);

/// UTF-8 as it is. Other bytes are taken for Latin-1, which old slicers write names and comments in.
std::string utf8Text(std::string_view text);

}  // namespace stratum
