// Puts the parts of a print together, to the bytes that one process would have written.
#pragma once

#include "export/level_set_output.h"

#include <filesystem>
#include <vector>

namespace stratum::exporter {

/// What was merged.
struct MergedPrint {
    WrittenGrid written;
    int parts = 0;
};

/// Copies the leaves of the parts one behind the other, as they are, some megabytes at a time; in memory are the nodes,
/// about 80 bytes of every leaf. Throws InputError that names each missing, doubled, foreign or damaged part, and
/// OutputError; nothing is written then.
MergedPrint mergePrint(const std::filesystem::path& output, const std::vector<std::filesystem::path>& paths);

}  // namespace stratum::exporter
