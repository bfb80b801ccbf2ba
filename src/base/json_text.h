// JSON as text.
#pragma once

#include <string>

namespace stratum {

/// What is not UTF-8, such as a file's name or a comment in Latin-1, becomes U+FFFD, where dump() alone would throw.
/// @param json    an nlohmann::json or ordered_json
/// @param indent  spaces a level; -1: one line
template <typename Json>
std::string jsonText(const Json& json, int indent = -1) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace stratum
