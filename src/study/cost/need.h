// What a scene does not use, and what it would have cost.
#pragma once

#include "study/study.h"

#include <string>
#include <vector>

namespace stratum::study {

struct NeedOptions {
    std::vector<std::string> prints;  ///< G-code files
    int repeats = 0;                  ///< runs of each; 0: 7, or 3 if quick
};

/// Converts and renders each print with every capability off, and with each one alone switched on; every run is a
/// process of its own, and the kinds take turns. need.csv has every run; need.html the medians: seconds and peak bytes
/// with and without. A second series with everything off tells how far two medians of the same thing are apart. Throws
/// InputError, UsageError, OutputError.
StudyReport studyNeed(const NeedOptions& options, const StudyOptions& common);

}  // namespace stratum::study
