// How outputs are called if nobody says, and where they go.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace stratum::tools {

/// part.gcode, part.gcode.gz, part.gcode.3mf -> part. Throws UsageError for "-": a stream has no name.
std::string stemOf(const std::string& input);

/// What the stems of a series begin with, without the number or the separator where they part: part_025pct and
/// part_100pct -> part. "series" if they have nothing in common.
std::string commonStem(const std::vector<std::string>& inputs);

/// Whether an output is meant as a folder: it is one, or ends in a slash.
bool namesFolder(const std::string& output);

/// Makes it if it is missing. Throws OutputError.
void makeFolder(const std::filesystem::path& folder);

}  // namespace stratum::tools
