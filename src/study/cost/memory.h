// Memory against voxel size.
#pragma once

#include "study/study.h"

#include <string>
#include <vector>

namespace stratum::study {

struct MemoryOptions {
    std::vector<std::string> prints;    ///< G-code files
    std::vector<int> voxels_per_layer;  ///< empty: 1 to 4, or 1 to 3 if quick
    double memory_share = 0.5;          ///< of what the machine has available: larger grids are left out
};

/// Builds every print at every voxel size, kept and culled, and kept without a grid, each in a process of its own.
/// memory.csv: bytes of the grid, on disk as floats and halves, as bricks, peak resident set of converting; leaves,
/// tiles, active voxels; seconds. memory.html: power laws, and how far off each is at the finest size when fitted
/// without it. Throws InputError, UsageError, OutputError.
StudyReport studyMemory(const MemoryOptions& options, const StudyOptions& common);

}  // namespace stratum::study
