// The part of --stats that is about the G-code.
#pragma once

#include "deposit/lay_flow.h"
#include "deposit/sag.h"
#include "gcode/toolpath/toolpath.h"

#include <nlohmann/json.hpp>

#include <string>

namespace stratum::tools {

/// Counts and sums; what each feature, tool and object takes; whose rules the file was read by, and why; the warnings.
nlohmann::ordered_json describeToolpath(const gcode::Toolpath& toolpath);

/// What flows out of the nozzle.
nlohmann::ordered_json describeFlow(const deposit::FlowReport& flow);
/// The same in a line of text.
std::string flowLine(const deposit::FlowReport& flow);
/// What hangs over nothing.
nlohmann::ordered_json describeSag(const deposit::SagReport& sag);
std::string sagLine(const deposit::SagReport& sag);

}  // namespace stratum::tools
