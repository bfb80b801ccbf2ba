// A film of vdbtrace: its frames, made or kept, one after the other into one file.
#pragma once

#include "trace_options.h"

#include <nlohmann/json.hpp>

namespace stratum::tools {

/// Decides what moves and how many frames that is, and checks it, before the work. To be called when the options are
/// parsed. Throws UsageError, InputError.
void planFilm(TraceCommand& command);

/// Makes the film of a planned command whose options are all decided, or a shard's share of its frames. Returns its
/// report. Throws UsageError, InputError, OutputError.
nlohmann::ordered_json traceFilm(const TraceCommand& command, int threads);

}  // namespace stratum::tools
