// How near the models of docs/deposit.md come to plastic, and what they cost.
#pragma once

#include "study/study.h"

#include <string>
#include <vector>

namespace stratum::study {

struct DepositOptions {
    std::vector<std::string> prints;  ///< G-code files, for volume and cost; may be empty: then only what is made here
    std::vector<std::string> timed;   ///< more of them, in any container, for their times alone
    std::string layers;               ///< of the volumes: "A:B", see voxelize::parseLayers; empty: "1:20"
    int repeats = 0;                  ///< runs of each cost; 0: 7, or 2 if quick
};

/// deposit_volume.csv, deposit_roughness.csv, deposit_corner.csv, deposit_time.csv, deposit_cost.csv and deposit.html:
/// volume of union, settled beads and a typical printer against what was fed; Ra and Rz of stacked walls beside
/// published figures; width of a corner against the lag; stated against planned times; what each effect costs. Throws
/// InputError, UsageError, OutputError.
StudyReport studyDeposit(const DepositOptions& options, const StudyOptions& common);

}  // namespace stratum::study
