// The part of --stats that is about the G-code.
#pragma once

#include "deposit/apply_flow.h"
#include "gcode/toolpath/toolpath.h"

#include <nlohmann/json.hpp>

#include <string>

namespace stratum::tools {

/// Counts and sums; what each feature, tool and object takes; whose rules the file was read by, and why; the warnings.
nlohmann::ordered_json describeToolpath(const gcode::Toolpath& toolpath);

/// What flows out of the nozzle.
nlohmann::ordered_json describeFlow(const deposit::FlowReport& flow);
/// The same in a line of text, with its line end.
std::string flowLine(const deposit::FlowReport& flow);

}  // namespace stratum::tools
