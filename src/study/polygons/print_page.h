// What the page of `vdbstudy polygons` tells of prints.
#pragma once

#include "study/report/page.h"
#include "study/study.h"

#include <string>
#include <vector>

namespace stratum::study {

/// Columns of polygons_prints.csv.
extern const char* const kPrintColumns;

/// Of the rows of one print and integrator, the fastest level set or the fastest peer: of those that are exact enough
/// for a picture of `spp` samples (1: a first look, or kComparedSamples), if any. Null where no time was measured.
const Row* bestOf(const Table& table, const std::vector<Row>& rows, bool level_sets, int spp);

/// Plots, the verdict on level sets against the best peer, and everything measured by one integrator. `what`: it in
/// words.
void addPrints(Page& page, const Table& table, const std::string& integrator, const std::string& what,
               StudyReport& report);

}  // namespace stratum::study
