// A comparison as JSON, with its units in the names.
#pragma once

#include "compare/comparison.h"

#include <nlohmann/json.hpp>

#include <string>

namespace stratum::compare {

nlohmann::ordered_json describe(const Comparison& comparison);

/// "turned by 30.00 degrees, moved by (1.000, 2.000, 0.000) mm".
std::string describe(const Rigid& placement);

}  // namespace stratum::compare
