// The pictures of one vdbtrace camera: of one input, of several that make a series, of a print that grows.
#pragma once

#include "batch.h"
#include "trace_options.h"

#include <nlohmann/json.hpp>

namespace stratum::tools {

/// Renders and writes all pictures of `command`, whose options are checked. Inputs that fail are the batch's; the
/// camera is of the last one that doesn't. Returns the pictures' reports.
nlohmann::ordered_json traceSeries(const TraceCommand& command, int threads, Batch& batch);

}  // namespace stratum::tools
