// Puts the parts of a picture together, to the bytes that one process would have written.
#pragma once

#include "shade/parts/part.h"

#include <filesystem>
#include <vector>

namespace stratum::shade {

/// What was merged.
struct MergedPicture {
    int width = 0, height = 0;  ///< of the file
    int parts = 0;
    double mean_spp = 0.0;
    bool denoised = false;
};

/// Reads the parts one after the other, denoises and maps tones as they say, and writes `output`. Its ending must be
/// that for which the parts were traced. Throws InputError that names each missing, doubled, foreign or damaged part,
/// UsageError and OutputError; nothing is written then.
MergedPicture mergeParts(const std::filesystem::path& output, const std::vector<std::filesystem::path>& paths);

}  // namespace stratum::shade
