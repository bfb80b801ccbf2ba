// Stiff and extreme cases, each with a quantity, a tolerance and a verdict.
#pragma once

#include "study/study.h"

#include <string>

namespace stratum::study {

/// Runs all cases, each in a process of its own, so that one that crashes or hangs fails alone. stability.csv and
/// stability.html; what failed is among the findings. Cases don't depend on --quick: they are quick. Throws UsageError,
/// OutputError.
StudyReport studyStability(const StudyOptions& common);

}  // namespace stratum::study
