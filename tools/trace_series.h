// The pictures of one vdbtrace camera: of one input, of several that make a series, of a print that grows.
#pragma once

#include "batch.h"
#include "trace_options.h"

#include "assemble/ready_scene.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <vector>

namespace stratum::tools {

/// How the command's files are read, and made ready for rays; what a pixel spans is left to the caller. Throws
/// UsageError.
assemble::TracingOptions readingOf(const TraceCommand& command);

/// What is read for input n: it alone, or the objects of the scene.
std::vector<assemble::ObjectOptions> objectsOf(const TraceCommand& command, std::size_t n);

/// What the scene around them depends on.
assemble::StageOptions stageOptionsOf(const TraceCommand& command);

/// Renders and writes all pictures of `command`, whose options are checked. Inputs that fail are the batch's; the
/// camera is of the last one that doesn't. Returns the pictures' reports.
nlohmann::ordered_json traceSeries(const TraceCommand& command, int threads, Batch& batch);

}  // namespace stratum::tools
