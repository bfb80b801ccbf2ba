// JSON -> shapes by formula.
#pragma once

#include "trace/sdf.h"

#include <nlohmann/json.hpp>

#include <string>

namespace stratum::assemble {

/// Reads an object with one key, the shape's or the operation's name; docs/shading.md lists them.
/// @param path  where it is in the file, for messages
/// Throws InputError with the path of what is wrong.
trace::SdfPtr readSdf(const nlohmann::json& json, const std::string& path, const std::string& file);

}  // namespace stratum::assemble
