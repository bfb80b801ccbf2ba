// gcode2vdb --shard: which part of a print is this process's, and whether it is there already.
#pragma once

#include "convert/conversion.h"

#include "export/parts/part_of_print.h"

#include <filesystem>
#include <string>
#include <vector>

namespace stratum::tools {

/// Reads --shard, and gives the outputs the names of its parts. Throws UsageError if what is asked for needs the whole
/// print.
void divide(ConvertCommand& command, std::vector<std::filesystem::path>& outputs);

/// What the part of an input is of.
exporter::PartOfPrint partOf(const ConvertCommand& command, const std::string& input);

}  // namespace stratum::tools
