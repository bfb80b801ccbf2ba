// --thumbnail: copies of prints with new pictures of themselves.
#pragma once

#include "convert/conversion.h"
#include "run_files.h"

#include <CLI/CLI.hpp>

namespace stratum::tools {

void addThumbnailOptions(CLI::App& app, ThumbnailCommand& options);

/// Writes a copy of each input, or replaces it if that is asked for. Throws InputError, UsageError, OutputError.
void writeThumbnails(ConvertCommand& command);

}  // namespace stratum::tools
