// The part of --stats that is about the G-code.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <nlohmann/json.hpp>

namespace stratum::tools {

/// Counts and sums; what each feature, tool and object takes; whose rules the file was read by, and why; the warnings.
nlohmann::ordered_json describeToolpath(const gcode::Toolpath& toolpath);

}  // namespace stratum::tools
